"""Being told to stop: what ends a process from outside ends it as Ctrl-C does."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGTERM, signal.SIGHUP)


class Stop:
    """By which signal we were told to stop."""

    def __init__(self) -> None:
        """Take Ctrl-C for it, until told otherwise."""
        self._number = signal.SIGINT

    @property
    def status(self) -> int:
        """The exit status of a process that a signal ended."""
        return 128 + self._number

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Pass a signal on to the handler of Ctrl-C that is set now."""
        self._number = signal.Signals(number)
        answer = signal.getsignal(signal.SIGINT)
        # in the background Ctrl-C may be ignored, which says nothing of other signals
        (answer if callable(answer) else signal.default_int_handler)(number, frame)


@contextmanager
def stoppable() -> Iterator[Stop]:
    """Turn SIGTERM and SIGHUP into a KeyboardInterrupt; one that is ignored (nohup) stays so.

    For the main thread alone: Python tells no other one of signals.
    """
    stop = Stop()
    ours = [each for each in _SIGNALS if signal.getsignal(each) is signal.SIG_DFL]
    for number in ours:
        signal.signal(number, stop.handle)
    try:
        yield stop
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
