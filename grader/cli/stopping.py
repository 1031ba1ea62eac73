"""Handle SIGTERM and SIGHUP like Ctrl-C, and a reader of stdout that is gone like SIGPIPE."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_SIGNALS = (signal.SIGTERM, signal.SIGHUP)


PIPE_CLOSED = 128 + signal.SIGPIPE
"""The exit status of a process that SIGPIPE ended; Python ignores this signal."""


def is_output_closed() -> bool:
    """Whether nothing reads stdout any more; if so, what is still in its buffer is discarded."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        # flushing the buffer at exit would raise again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


class Stop:
    """The signal by which this process was told to stop."""

    def __init__(self) -> None:
        """Assume Ctrl-C until another signal arrives."""
        self._number = signal.SIGINT

    @property
    def status(self) -> int:
        """The exit status of a process that this signal ended."""
        return 128 + self._number

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Pass a signal on to the current handler of Ctrl-C."""
        self._number = signal.Signals(number)
        answer = signal.getsignal(signal.SIGINT)
        # a background process may ignore Ctrl-C, but must still react to other signals
        (answer if callable(answer) else signal.default_int_handler)(number, frame)


@contextmanager
def stoppable() -> Iterator[Stop]:
    """Turn SIGTERM and SIGHUP into KeyboardInterrupt, unless they are ignored (nohup).

    For the main thread only: Python handles signals in no other thread.
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
