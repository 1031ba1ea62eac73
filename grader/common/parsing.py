"""Let a process of its own read what strangers wrote: no text of theirs can stop a run.

`python -m grader.common.parsing_process` is started once, or as often as threads ask at the same
time. It is asked over a pipe, and forks a process for each question, with limits on processor
time, wall time and memory. Both ways go JSON.
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
"""How many questions are answered at a time: the process that asks can prepare no more."""
END_GRACE_SEC = 60
"""How long a process that its limits should have ended may take to be gone: machines are busy."""


@dataclass(frozen=True)
class Limits:
    """What reading one text may take."""

    cpu_sec: int = 20
    wall_sec: int = 300
    """A machine may be busy: only what waits for nothing reaches it."""
    memory_bytes: int = 2**30
    """Of addresses, what the process begins with included: about 0.3 GB."""


class ParsingFailed(Exception):
    """Says in a few words why a text was not read to its end."""


def parse(function: str, *arguments: object, limits: Limits | None = None) -> Any:
    """Call `module:function` on JSON in a process with limits; return its answer.

    Threads are answered side by side, AT_ONCE at a time. Raises ParsingFailed where it does not
    come to an answer, OSError where that is the disk's fault, and CourseError where there is no
    such process.
    """
    return _SERVERS.ask(function, arguments, limits or Limits())


def call_off() -> None:
    """End whatever is asked just now: whoever waits for it gets CourseError."""
    _SERVERS.call_off()


class _Server:
    """A process that is asked by one thread at a time."""

    def __init__(self) -> None:
        self._process: subprocess.Popen | None = None
        self.is_called_off = False

    def ask(self, function: str, arguments: Sequence[object], limits: Limits) -> Any:
        question = json.dumps([function, arguments, asdict(limits)]).encode('ascii') + b'\n'
        try:
            answer = self._answer(question, limits)
        except BaseException:
            self.end()  # what it still has to say belongs to nobody
            raise
        match answer:
            case {'answer': found}:
                return found
            case {'errno': int(number)}:
                raise OSError(number, os.strerror(number))
        raise ParsingFailed(answer['why'])

    def kill(self) -> None:
        """End it with whatever it has forked, while another thread starts it or waits for it."""
        self.is_called_off = True
        if process := self._process:
            with contextlib.suppress(ProcessLookupError):  # that thread has ended it itself
                os.killpg(process.pid, signal.SIGKILL)

    def end(self) -> None:
        """End it with whatever it has forked."""
        if self._process:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.communicate()
            self._process = None

    def _answer(self, question: bytes, limits: Limits) -> dict:
        if self._process is None:
            self._process = subprocess.Popen(
                COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
            )  # the process that asks handles Ctrl-C
        if self.is_called_off:  # before there was a process to end
            raise CourseError('nobody waits for the answer any more: run this again')
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
                'the process that reads what students wrote has ended, which no text of theirs '
                'brings about: see what it printed above, and run this again'
            )
        return json.loads(line)


class _Servers:
    """All of them: as many as threads ask at once, and others after a fork."""

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

    def call_off(self) -> None:
        for each in [*self._busy]:
            each.kill()

    def end(self) -> None:
        while self._idle:
            self._idle.pop().end()


_SERVERS = _Servers()
atexit.register(_SERVERS.end)
os.register_at_fork(after_in_child=lambda: _Servers.__init__(_SERVERS))
