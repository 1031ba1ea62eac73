"""Read what students wrote in a separate process, so that such text can never stop a run.

`python -m grader.common.parsing_process` is started for each thread that needs it at the same
time, and reused. It gets requests over a pipe, and forks a process for each one, with limits on
CPU time, wall time and memory. Requests and answers are JSON.
"""

import atexit
import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from grader.common.errors import CourseError

COMMAND = (sys.executable, '-P', '-m', 'grader.common.parsing_process')
MAX_ANSWER_BYTES = 100_000_000
AT_ONCE = min(4, len(os.sched_getaffinity(0)))
"""How many requests run at a time: the calling process can't prepare more."""
END_GRACE_SEC = 60
"""How much later than its wall time limit a process is killed: the machine may be busy."""


@dataclass(frozen=True)
class Limits:
    """Limits for reading one text."""

    cpu_sec: int = 20
    wall_sec: int = 300
    """Long, as a machine may be busy: only a process that hangs reaches it."""
    memory_bytes: int = 2**30
    """Address space, including the 0.3 GB that the process has at its start."""


class ParsingFailed(Exception):
    """Why a text could not be read completely, in a few words."""


def parse(function: str, *arguments: object, limits: Limits | None = None) -> Any:
    """Call `module:function` with JSON arguments in a process with limits; return its result.

    Calls of several threads run at the same time, AT_ONCE at most. Raises ParsingFailed if it
    gives no result, OSError if the disk is the cause, and CourseError if the process can't run.
    """
    return _SERVERS.ask(function, arguments, limits or Limits())


def cancel_requests() -> None:
    """End all requests that are running: their callers get a CourseError."""
    _SERVERS.cancel_requests()


class _Server:
    """One such process, used by one thread at a time."""

    def __init__(self) -> None:
        self._process: subprocess.Popen | None = None
        self.is_called_off = False

    def ask(self, function: str, arguments: Sequence[object], limits: Limits) -> Any:
        question = json.dumps([function, arguments, asdict(limits)]).encode('ascii') + b'\n'
        try:
            answer = self._answer(question, limits)
        except BaseException:
            self.end()  # or a late answer would be read as that of the next request
            raise
        match answer:
            case {'answer': found}:
                return found
            case {'errno': int(number)}:
                raise OSError(number, os.strerror(number))
        raise ParsingFailed(answer['why'])

    def kill(self) -> None:
        """Kill it and what it has forked, while another thread starts it or waits for it."""
        self.is_called_off = True
        if process := self._process:
            with contextlib.suppress(ProcessLookupError):  # the other thread has ended it
                os.killpg(process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Kill it and what it has forked."""
        if self._process:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.communicate()
            self._process = None

    def _answer(self, question: bytes, limits: Limits) -> dict:
        if self._process is None:
            self._process = subprocess.Popen(
                COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
            )  # start_new_session: the calling process handles Ctrl-C
        if self.is_called_off:  # kill() was called before the process was started
            raise CourseError('reading was stopped, because the program ends: run this again')
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        late = threading.Timer(limits.wall_sec + END_GRACE_SEC, self._process.kill)
        late.daemon = True
        late.start()
        try:
            self._process.stdin.write(question)
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        finally:
            late.cancel()
        if not line.endswith(b'\n'):
            raise CourseError(
                'the process that reads student files has ended, and no student file can cause '
                'that: read what it printed above, then run this again'
            )
        return json.loads(line)


class _Servers:
    """All such processes: one for each thread that needs one; a forked process starts its own."""

    def __init__(self) -> None:
        self._free = threading.Semaphore(AT_ONCE)
        self._idle: list[_Server] = []
        self._busy: list[_Server] = []

    def ask(self, function: str, arguments: Sequence[object], limits: Limits) -> Any:
        with self._free:
            server = self._idle.pop() if self._idle else _Server()
            self._busy.append(server)
            try:
                return server.ask(function, arguments, limits)
            finally:
                self._busy.remove(server)
                if not server.is_called_off:
                    self._idle.append(server)

    def cancel_requests(self) -> None:
        for each in [*self._busy]:
            each.kill()

    def end(self) -> None:
        while self._idle:
            self._idle.pop().end()


_SERVERS = _Servers()
atexit.register(_SERVERS.end)
os.register_at_fork(after_in_child=lambda: _Servers.__init__(_SERVERS))
