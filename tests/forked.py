"""For tests: programs that begin in a fork of a process that has imported rclpy once.

`python program` imports for some 0.4 s each time; all else is as if it had been called so.
"""

import ctypes
import multiprocessing
import os
import runpy
import sys
import tempfile
from dataclasses import dataclass
from multiprocessing.context import ForkServerProcess
from pathlib import Path

import pytest

CONTEXT = multiprocessing.get_context('forkserver')
CONTEXT.set_forkserver_preload(['preloaded'])


@dataclass(frozen=True)
class Streams:
    """The files that are a program's standard streams."""

    stdin: str | Path = os.devnull
    stdout: str | Path = os.devnull
    stderr: str | Path = os.devnull


@dataclass(frozen=True)
class Ended:
    status: int
    out: str
    err: str


def start(
    *command: str | Path, streams: Streams | None = None, **environment: str
) -> ForkServerProcess:
    """Start a Python file with its arguments; `exitcode` is what a Popen's `returncode` is."""
    words = [str(word) for word in command]
    process = CONTEXT.Process(
        target=_become,
        args=(words, streams or Streams(), {**os.environ, **environment}, os.getcwd()),
        daemon=True,
    )
    with pytest.MonkeyPatch.context() as patch:
        # the first one starts the server, which finds `preloaded` there
        patch.setenv('PYTHONPATH', str(Path(__file__).parent))
        process.start()
    return process


def run(*command: str | Path, stdin: str, patience_sec: float, **environment: str) -> Ended:
    """Run a Python file with its arguments to its end, or raise TimeoutError."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder, name) for name in ('stdin', 'stdout', 'stderr')]
        paths[0].write_text(stdin, encoding='utf-8')
        process = start(*command, streams=Streams(*paths), **environment)
        process.join(patience_sec)
        if process.exitcode is None:
            process.kill()
            raise TimeoutError(f'{command} has not ended in {patience_sec:g} s')
        _, out, err = (path.read_text(encoding='utf-8') for path in paths)
    return Ended(process.exitcode, out, err)


def stop(process: ForkServerProcess, patience_sec: float = 5.0) -> None:
    """End it in good order: whoever is killed stays on the graph as a ghost for a while."""
    process.terminate()
    process.join(patience_sec)
    if process.exitcode is None:
        process.kill()
        process.join()


def _become(words: list[str], streams: Streams, environment: dict[str, str], cwd: str) -> None:
    """Be `python words...`, to the last: the interpreter ends as a whole one does."""
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    os.dup2(os.open(streams.stdin, os.O_RDONLY), 0)
    for number, path in ((1, streams.stdout), (2, streams.stderr)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), number)
    sys.stdin = open(0, encoding='utf-8', closefd=False)  # noqa: SIM115 - multiprocessing has closed it
    sys.argv[:] = words
    sys.path.insert(0, os.path.dirname(words[0]))
    ctypes.pythonapi.Py_Exit(_status_of(words[0]))


def _status_of(path: str) -> int:
    try:
        runpy.run_path(path, run_name='__main__')
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        sys.excepthook(*sys.exc_info())
        return 1
    return 0
