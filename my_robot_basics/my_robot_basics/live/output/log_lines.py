"""Separate the lines of the ROS logger from everything else that a process writes to stdout."""

import re
from collections.abc import Callable
from dataclasses import dataclass

RECORD_END = '\x1f'
"""Unit separator, written after each record, to find the end of a record with several lines."""

CONSOLE_FORMAT = '[{severity}] [{time}] [{name}]: {message}' + RECORD_END
"""ROS's default format with the separator, for RCUTILS_CONSOLE_OUTPUT_FORMAT."""

_START = re.compile(rb'\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[\d+\.\d+\] \[([^\]\n]*)\]: ')
_END = RECORD_END.encode()


@dataclass(frozen=True)
class LogRecord:
    """One message of a logger."""

    severity: str
    """DEBUG, INFO, WARN, ERROR or FATAL."""

    logger: str
    """The logger's name: the node's, or a child's, such as `arm.left`."""

    text: str
    """The message, without severity, time and name; it may have several lines."""


class Splitter:
    """Splits a stream of bytes into wanted log records and all other bytes."""

    def __init__(
        self, *, take: Callable[[LogRecord], bool], forward: Callable[[bytes], None]
    ) -> None:
        """Pass each record to `take`; if that returns False, and other bytes, to `forward`."""
        self._take = take
        self._forward = forward
        self._pending = b''
        self._marked = True
        """Whether records end with the separator: not if logging was set up earlier."""

    @property
    def waiting(self) -> bool:
        """Whether bytes are kept back because a record may be incomplete."""
        return bool(self._pending)

    def feed(self, data: bytes) -> None:
        """Take the next bytes."""
        plain = bytearray()
        lines = (self._pending + data).splitlines(keepends=True)
        self._pending = b''
        while lines:
            start = _START.match(lines[0])
            if start is None:
                if len(lines) == 1 and _may_become_a_record(lines[0]):
                    self._pending = lines.pop()
                else:
                    plain += lines.pop(0)
                continue
            length = self._length_of_record(lines)
            if length is None:
                self._pending = b''.join(lines)
                break
            raw, lines = b''.join(lines[:length]), lines[length:]
            plain += self._hand_on(raw, start)
        if plain:
            self._forward(bytes(plain))

    def give_up_waiting(self) -> None:
        """Treat the bytes that are kept back as complete, since no more came."""
        raw, self._pending = self._pending, b''
        start = _START.match(raw)
        if start is not None and raw.endswith(b'\n'):
            self._marked = False
            self.feed(raw)
        elif raw:
            self._forward(raw)

    def _length_of_record(self, lines: list[bytes]) -> int | None:
        """Return how many lines the first record has; None while that is unknown."""
        for number, line in enumerate(lines, start=1):
            if line.endswith(_END + b'\n'):
                self._marked = True
                return number
            if number > 1 and _START.match(line):
                self._marked = False
                return 1
            if not self._marked and line.endswith(b'\n'):
                return 1
        return None

    def _hand_on(self, raw: bytes, start: re.Match[bytes]) -> bytes:
        """Pass a record to `take`; return the bytes to forward if it is not wanted."""
        raw = raw.removesuffix(b'\n').removesuffix(_END)
        severity, logger, text = (
            part.decode(errors='replace') for part in (*start.groups(), raw[start.end() :])
        )
        return b'' if self._take(LogRecord(severity, logger, text)) else raw + b'\n'


def _may_become_a_record(tail: bytes) -> bool:
    return not tail.endswith((b'\n', b'\r')) and tail.startswith(b'[')
