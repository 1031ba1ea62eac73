"""Let a process of its own read what strangers wrote: no text of theirs can stop a run.

The caller starts `python -m grader.common.parsing` once. It is asked over a pipe, and forks a
process for each question, with limits on processor time, wall time and memory. Both ways go JSON.
"""

import atexit
import importlib
import json
import os
import resource
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, BinaryIO

from grader.common.errors import CourseError

COMMAND = (sys.executable, '-P', '-m', 'grader.common.parsing')
MAX_ANSWER_BYTES = 100_000_000
END_GRACE_SEC = 60
"""A process that was to be ended by its limits gets so long, on a busy machine, to be gone."""


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

    Raises ParsingFailed where it does not come to one, OSError where that is the disk's fault, and
    CourseError where there is no such process.
    """
    return _SERVER.ask(function, arguments, limits or Limits())


class _Server:
    """The process that is asked; one for all threads, and a new one after a fork."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen | None = None

    def ask(self, function: str, arguments: Sequence[object], limits: Limits) -> Any:
        question = json.dumps([function, arguments, asdict(limits)]).encode('ascii') + b'\n'
        with self._lock:
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


_SERVER = _Server()
atexit.register(_SERVER.end)
os.register_at_fork(after_in_child=lambda: _Server.__init__(_SERVER))


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer one question a line, until nobody asks any more."""
    for line in questions:
        function, arguments, limits = json.loads(line)
        module, _, name = function.partition(':')
        call = getattr(importlib.import_module(module), name)
        answers.write(_forked(call, arguments, Limits(**limits)) + b'\n')
        answers.flush()


def _forked(call: Callable[..., object], arguments: list, limits: Limits) -> bytes:
    """Return what a process of its own comes to, as JSON."""
    ours, theirs = os.pipe()
    process = os.fork()
    if not process:
        os.close(ours)
        _answer_and_exit(call, arguments, limits, theirs)
    os.close(theirs)
    with open(ours, 'rb') as pipe:
        answer = pipe.read(MAX_ANSWER_BYTES)
        if pipe.read(1):
            os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    if os.waitstatus_to_exitcode(status) == 0:
        return answer
    return _packed({'why': _why(-os.waitstatus_to_exitcode(status), limits)})


def _answer_and_exit(
    call: Callable[..., object], arguments: list, limits: Limits, pipe: int
) -> None:
    status = 1
    try:
        # each of them ends the process when it is reached
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (limits.cpu_sec, limits.cpu_sec + 1))
        resource.setrlimit(resource.RLIMIT_AS, (limits.memory_bytes, limits.memory_bytes))
        signal.alarm(limits.wall_sec)
        with open(pipe, 'wb') as answers:
            answers.write(_come_to(call, arguments))
        status = 0
    except MemoryError:
        status = 2
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(status)


def _come_to(call: Callable[..., object], arguments: list) -> bytes:
    try:
        return _packed({'answer': call(*arguments)})
    except OSError as error:
        return _packed({'errno': error.errno or 0})
    except MemoryError:
        return _packed({'why': 'it takes too much memory'})
    except RecursionError:
        return _packed({'why': 'it is nested too deep'})
    except Exception as error:  # whatever their text makes a library raise
        return _packed({'why': f'{type(error).__name__}: {error}'[:500]})


def _why(number: int, limits: Limits) -> str:
    """Put into words by which signal a process was ended."""
    return {
        signal.SIGXCPU: f'it takes over {limits.cpu_sec} s of processor time',
        signal.SIGALRM: f'it takes over {limits.wall_sec} s',
        signal.SIGKILL: 'it takes too much memory, or too long an answer',
        -2: 'it takes too much memory',
    }.get(number, f'what reads such files crashed on it ({number})')


def _packed(answer: dict) -> bytes:
    return json.dumps(answer).encode('ascii')


if __name__ == '__main__':
    with open(os.dup(1), 'wb') as own_pipe:
        os.dup2(2, 1)  # what a library prints is no answer
        serve(sys.stdin.buffer, own_pipe)
