"""A program that a notebook has started, with its output; it ends with the kernel."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence

END_SEC = 5.0
"""How long a program may take to end after SIGINT."""
FIRM_SEC = 2.0
"""How long it may then take to end after SIGTERM, before it is killed."""
MOST_LINES, LONGEST = 40, 400
"""How many lines of its output are kept, and characters of each."""
_DIES_WITH_US = (  # so that a kernel that is killed leaves no node behind
    'import ctypes, os, sys; ctypes.CDLL(None).prctl(1, 15); os.execv(sys.argv[1], sys.argv[1:])'
)


class Process:
    """One program in a process group of its own, and the last lines that it has printed."""

    def __init__(
        self,
        command: Sequence[str],
        *,
        on_line: Callable[[str], None] = lambda line: None,
        environment: Mapping[str, str] | None = None,
        on_end: Callable[[int], None] = lambda code: None,
    ) -> None:
        """Start a program, whose path is the first word of `command`.

        `on_line` gets each line that it prints, and `on_end` its exit code, negative for a signal.
        Both are called in a thread.
        """
        self._on_line, self._on_end = on_line, on_end
        self.lines: deque[str] = deque(maxlen=MOST_LINES)
        self.process = subprocess.Popen(
            [sys.executable, '-IS', '-c', _DIES_WITH_US, *command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors='replace',
            process_group=0,  # an interrupt of the cell must not reach the program
            env={**os.environ, 'PYTHONUNBUFFERED': '1', **(environment or {})},
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self.process.poll()

    def send(self, number: signal.Signals) -> None:
        """Send a signal to its process group, as Ctrl-C does."""
        if self.process.poll() is None:
            try:
                os.killpg(self.process.pid, number)
            except ProcessLookupError:  # it has joined another group
                self.process.send_signal(number)

    def stop(self) -> signal.Signals | None:
        """End it by SIGINT, else SIGTERM, else SIGKILL; return the signal that was needed.

        None if it had ended before.
        """
        if self.process.poll() is not None:
            return None
        for number, timeout_sec in (
            (signal.SIGINT, END_SEC),
            (signal.SIGTERM, FIRM_SEC),
            (signal.SIGKILL, END_SEC),
        ):
            self.send(number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(timeout_sec)
                break
        self._reader.join(FIRM_SEC)
        return number

    def wait_for_lines(self) -> None:
        """Wait until all of its output is read, after its end."""
        self._reader.join(FIRM_SEC)

    def _read(self) -> None:
        assert self.process.stdout is not None  # it is a pipe
        while line := self.process.stdout.readline(LONGEST):
            if text := line.rstrip():
                self.lines.append(text)
                self._on_line(text)
        self._on_end(self.process.wait())
