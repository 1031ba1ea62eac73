"""What ends a command with a sentence instead of a result."""


class CommandError(RuntimeError):
    """The command can't do what was asked; its text goes to stderr, the exit status is 1."""


class Stopped(Exception):
    """SIGINT, SIGTERM or SIGHUP arrived."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number
