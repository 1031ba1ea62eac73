"""Run nbgrader's command in processes forked from one that has imported it.

Importing nbgrader takes longer than releasing a lesson, and tests release many lessons.
"""

import multiprocessing
import os
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path

NBGRADER = [sys.executable, '-m', 'nbgrader']
_forking = multiprocessing.get_context('forkserver')
_forking.set_forkserver_preload(['nbgrader.apps', 'nbgrader.apps.nbgraderapp'])


def run(command: list, *, cwd: Path, **options: object) -> subprocess.CompletedProcess:
    """Run a command as subprocess.run does; nbgrader's command runs in a forked process."""
    if command[:3] != NBGRADER:
        return subprocess.run(command, cwd=cwd, **options)
    with tempfile.TemporaryDirectory() as folder:
        out, err = (Path(folder, name) for name in ('out', 'err'))
        process = _forking.Process(
            target=_nbgrader, args=(command[3:], cwd, dict(os.environ), out, err)
        )
        process.start()
        process.join()
        said = out.read_text(), err.read_text()
    return subprocess.CompletedProcess(command, process.exitcode, *said)


def _nbgrader(arguments: list[str], cwd: Path, environment: dict, out: Path, err: Path) -> None:
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(cwd)
    for descriptor, path in ((1, out), (2, err)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), descriptor)
    sys.argv = ['nbgrader', *arguments]
    runpy.run_module('nbgrader', run_name='__main__', alter_sys=True)
