"""The process that `grader.common.parsing` starts: it forks a limited one for each request."""

import importlib
import json
import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from functools import cache
from typing import BinaryIO

from grader.common.parsing import MAX_ANSWER_BYTES, Limits


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer one request per line, until the pipe is closed."""
    for line in questions:
        function, arguments, limits = json.loads(line)
        answers.write(_forked(_function(function), arguments, Limits(**limits)) + b'\n')
        answers.flush()


@cache
def _function(name: str) -> Callable[..., object]:
    """Import the function; call its module's `get_ready`, if any, once for all requests."""
    module, _, function = name.partition(':')
    found = importlib.import_module(module)
    getattr(found, 'get_ready', lambda: None)()
    return getattr(found, function)


def _forked(call: Callable[..., object], arguments: list, limits: Limits) -> bytes:
    """Call the function in a forked process; return its answer as JSON."""
    ours, theirs = os.pipe()
    process = os.fork()
    if not process:
        os.close(ours)
        _answer_and_exit(call, arguments, limits, theirs)
    os.close(theirs)
    with open(ours, 'rb') as pipe:
        answer = pipe.read(MAX_ANSWER_BYTES)
        is_too_long = bool(pipe.read(1))
        if is_too_long:
            os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    number = os.waitstatus_to_exitcode(status)
    if is_too_long:  # it may have exited before the signal arrived
        number = -signal.SIGKILL
    return answer if number == 0 else _packed({'why': _signal_reason(-number, limits)})


def _answer_and_exit(
    call: Callable[..., object], arguments: list, limits: Limits, pipe: int
) -> None:
    status = 1
    try:
        # each of these limits ends the process when it is reached
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
    except Exception as error:  # whatever a library raises for a student's text
        return _packed({'why': f'{type(error).__name__}: {error}'[:500]})


def _signal_reason(number: int, limits: Limits) -> str:
    """Describe the signal that ended a process."""
    return {
        signal.SIGXCPU: f'it takes over {limits.cpu_sec} s of processor time',
        signal.SIGALRM: f'it takes over {limits.wall_sec} s',
        signal.SIGKILL: 'it takes too much memory, or too long an answer',
        -2: 'it takes too much memory',
    }.get(number, f'the program that reads such files crashed on it ({number})')


def _packed(answer: dict) -> bytes:
    return json.dumps(answer).encode('ascii')


if __name__ == '__main__':
    with open(os.dup(1), 'wb') as own_pipe:
        os.dup2(2, 1)  # what a library prints must not be read as an answer
        serve(sys.stdin.buffer, own_pipe)
