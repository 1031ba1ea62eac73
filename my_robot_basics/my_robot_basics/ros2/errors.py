"""Exceptions that end a command without a result."""


class CommandError(RuntimeError):
    """The command fails; the text of the exception goes to stderr, and the exit status is 1."""


class Stopped(Exception):
    """SIGINT, SIGTERM or SIGHUP arrived."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number
