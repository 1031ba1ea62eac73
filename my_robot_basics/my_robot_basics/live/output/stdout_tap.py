"""Read what C code writes to stdout: in a notebook, the ROS logger has no other output.

In a notebook kernel, file descriptor 1 writes into the cell that happens to run. A pipe in front
of it passes each node's log lines to the cell that started the node, and the rest to stdout.
"""

import contextlib
import fcntl
import itertools
import os
import select
import threading
from collections.abc import Callable

from my_robot_basics.live.output.log_lines import LogRecord, Splitter

PIPE_BYTES = 1 << 20
"""rclpy logs while it holds the GIL: if the pipe were full, the reading thread could not run."""

GRACE_SEC = 0.05
"""How long an unfinished line is kept back."""


class StdoutTap:
    """A pipe in front of file descriptor 1, and the thread that reads it."""

    def __init__(self) -> None:
        """Redirect file descriptor 1 into the pipe and start the thread."""
        self._sinks: dict[str, Callable[[LogRecord], None]] = {}
        self._marks: dict[bytes, threading.Event] = {}
        self._numbers = itertools.count()
        self._splitter = Splitter(take=self._take, forward=self._forward)
        self._former = os.dup(1)
        self._reader, writer = os.pipe()
        with contextlib.suppress(OSError):  # Linux may limit a pipe's size to less
            fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
        os.dup2(writer, 1)
        os.close(writer)
        self._closed = threading.Event()
        threading.Thread(target=self._read, name='live stdout', daemon=True).start()

    def give(self, logger: str, sink: Callable[[LogRecord], None]) -> None:
        """Pass the records of the logger with that name and its children to `sink` from now on."""
        self._sinks[logger] = sink

    def take_back(self, sink: Callable[[LogRecord], None]) -> None:
        """Stop passing records to `sink`: they go to stdout again."""
        self._sinks = {name: s for name, s in self._sinks.items() if s != sink}

    def sync(self) -> None:
        """Return when all that was written so far has been passed on, after 2 s at most."""
        if not self._closed.is_set():
            self._mark().wait(2.0)

    def close(self) -> None:
        """Restore file descriptor 1."""
        self.sync()
        self._closed.set()
        done = self._mark()
        os.dup2(self._former, 1)
        done.wait(2.0)

    def _mark(self) -> threading.Event:
        mark = b'\0live %d\0\n' % next(self._numbers)
        seen = self._marks[mark] = threading.Event()
        os.write(1, mark)
        return seen

    def _read(self) -> None:
        while not (self._closed.is_set() and not self._marks):
            grace = GRACE_SEC if self._splitter.waiting else None
            if not select.select([self._reader], [], [], grace)[0]:
                self._splitter.give_up_waiting()
                continue
            data = os.read(self._reader, PIPE_BYTES)
            if not data:
                break
            self._hand_on(data)

    def _hand_on(self, data: bytes) -> None:
        for mark in list(self._marks):
            before, found, after = data.partition(mark)
            if found:
                self._splitter.feed(before)
                self._splitter.give_up_waiting()
                self._marks.pop(mark).set()
                data = after
        if data:
            self._splitter.feed(data)

    def _take(self, record: LogRecord) -> bool:
        name = record.logger
        while name:
            sink = self._sinks.get(name)
            if sink is not None:
                sink(record)
                return True
            name = name.rpartition('.')[0]
        return False

    def _forward(self, data: bytes) -> None:
        with contextlib.suppress(OSError):  # the reader of this process's stdout is gone
            while data:
                data = data[os.write(self._former, data) :]
