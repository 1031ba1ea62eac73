"""A cell's panel: the log lines and the troubles of the node that the cell has started."""


class Panel:
    """What one node says."""

    def __init__(self, title: str) -> None:
        self._title = title

    def listen(self, name: str) -> None:
        """Show the log lines of the node of that fully qualified name."""

    def adopt_thread(self) -> None:
        """Let what this thread prints appear with the panel's cell."""

    def show(self) -> None:
        """Publish the panel."""

    def error(self, error: BaseException) -> None:
        """Show an exception of a callback."""
        print(f'{self._title}: {type(error).__name__}: {error}')

    def close(self, reason: str) -> None:
        """End the panel."""
