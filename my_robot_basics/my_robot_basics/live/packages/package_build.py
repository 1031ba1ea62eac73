"""Build one package with colcon from a copy, so that the student's folder is not changed."""

import contextlib
import os
import re
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.live.packages.dependencies import undeclared_dependencies
from my_robot_basics.live.packages.install_faults import fault_in_install
from my_robot_basics.live.packages.package_faults import fault_in_sources, fault_in_words
from my_robot_basics.session import classroom, package_files, subreaper

MOST_WORDS = 20_000
"""How many bytes of colcon's output are kept, the last ones."""
_LOOK_EVERY_SEC, _IN_A_PIPE = 0.5, 65_536
"""How often to test whether colcon has ended, and how many bytes its pipe may contain then."""
_END_SEC = 10.0
"""How long to wait for the end of all processes that a build has started."""
_STAGED = '.packages'
"""The copy's folder in the workspace; colcon ignores folders that begin with a dot."""
_ESCAPES = re.compile(r'\x1b\[[0-9;?]*[A-Za-z]')


@dataclass(frozen=True)
class Build:
    """The result of a build."""

    package: str
    status: int | None
    """colcon's exit code, negative for a signal; None if it was not run."""
    problem: str
    """What is wrong, and what to do, in a sentence; '' if the package can be run."""
    words: str = ''
    """The end of colcon's output."""
    executables: tuple[str, ...] = ()
    """The executables that `ros2 run` finds in it."""
    left_out: tuple[str, ...] = ()
    """Files in its folder that do not belong to it, each with the reason."""
    undeclared: tuple[str, ...] = ()
    """What package.xml should name, too, for a robot; nothing that stops the package here."""


def prefix_of(package: str) -> Path:
    """Return the folder in which a package is installed in the workspace."""
    return classroom.workspace() / 'install' / package


def executables_of(package: str) -> tuple[str, ...]:
    """Return the executables that `ros2 run` finds in a package that was built."""
    folder = prefix_of(package) / 'lib' / package
    if not folder.is_dir():
        return ()
    return tuple(sorted(p.name for p in folder.iterdir() if os.access(p, os.X_OK)))


def build(package: str, folder: Path) -> Build:
    """Build the package in `folder`; build/, install/ and log/ are in the workspace.

    The same files are used as by the grader. A fault of the package is returned, not raised.
    """
    try:
        files = package_files.read(folder)
    except OSError as error:
        return Build(package, None, f'{package}/ cannot be read: {error.strerror}')
    if files.problem:
        problem = f'{package}/ is not taken: {files.problem}'
        return Build(package, None, problem, left_out=files.left_out)
    problem = fault_in_sources(package, files)
    if problem:
        return Build(package, None, problem, left_out=files.left_out)
    try:
        status, words = _run_colcon(package, files.taken)
    except OSError as error:
        problem = f'{package} could not be built: {error.strerror or error}'
        return Build(package, None, problem, left_out=files.left_out)
    problem = fault_in_words(package, status, words) if status else ''
    problem = problem or fault_in_install(package, prefix_of(package), files)
    undeclared = () if problem else undeclared_dependencies(package, files)
    found = executables_of(package)
    return Build(package, status, problem, words, found, files.left_out, undeclared)


def _run_colcon(package: str, files: Mapping[str, Path]) -> tuple[int, str]:
    """Build from a fresh copy; return colcon's exit code, and the end of its output."""
    workspace = classroom.workspace()
    staged = workspace / _STAGED / package
    for former in (staged, workspace / 'build' / package, workspace / 'install' / package):
        _remove(former)
    package_files.write(files, staged)
    command = [
        *(sys.executable, '-I', '-S', subreaper.__file__),
        *(str(Path(sys.prefix, 'bin', 'colcon')), '--log-base', str(workspace / 'log')),
        *('build', '--base-paths', str(staged), '--packages-select', package),
        *('--build-base', str(workspace / 'build'), '--install-base', str(workspace / 'install')),
        *('--executor', 'sequential', '--event-handlers', 'console_cohesion-', 'console_stderr+'),
    ]
    colcon = subprocess.Popen(
        command,
        cwd=workspace,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        process_group=0,
    )
    try:
        words = _end_of(colcon)
        return colcon.wait(), words
    finally:
        # after an interrupt of the cell: end also all that the package's setup.py has started
        colcon.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            colcon.wait(_END_SEC)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(colcon.pid, signal.SIGKILL)
        colcon.wait()


def _end_of(colcon: subprocess.Popen) -> str:
    """Read colcon's output until it ends; return the last part of it as text.

    Meanwhile, subreaper.py ends processes that setup.py leaves behind, which may hold the pipe.
    """
    assert colcon.stdout is not None  # it is a pipe
    kept = b''
    with colcon.stdout as pipe:
        while True:
            has_ended = colcon.poll() is not None
            waits_sec = 0.0 if has_ended else _LOOK_EVERY_SEC
            is_ready = bool(select.select([pipe], [], [], waits_sec)[0])
            chunk = os.read(pipe.fileno(), _IN_A_PIPE) if is_ready else b''
            kept = (kept + chunk)[-MOST_WORDS:]
            if has_ended or (is_ready and not chunk):
                break
    return _ESCAPES.sub('', kept.decode(errors='replace'))


def _remove(folder: Path) -> None:
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
    elif folder.exists():
        shutil.rmtree(folder)
