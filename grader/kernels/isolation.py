"""Whether this machine can keep student code in a sandbox; if not, what is missing."""

import contextlib
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from grader.common.errors import CourseError
from grader.common.pool import Pool
from grader.kernels.fork_client import fork_into
from grader.kernels.fork_servers import NoForkedKernel
from grader.sandbox.cgroup_hierarchies import command_in_scope
from grader.sandbox.remedies import remedy
from grader.sandbox.sandbox import Sandbox

TRUST = 'MY_ROBOT_BASICS_TRUST_STUDENTS'
"""Set to 1, this variable tells nbgrader's commands what `--trust-students` tells `./course`."""
NO_SANDBOX = 'graded without a sandbox: this machine has none'
"""Shown once in each feedback, in the scores and above the table of what was graded so."""
OLDEST_BWRAP = (0, 8)

_TOOLS = {
    'bwrap': 'bubblewrap', 'nsenter': 'util-linux', 'setpriv': 'util-linux',
    'prlimit': 'util-linux', 'choom': 'util-linux', 'mount': 'mount',
}  # fmt: skip
"""Programs, and the packages of Debian and Ubuntu that contain them."""
_ROOM = ['bwrap', '--unshare-user', '--ro-bind', '/', '/']
_TRIED = {
    'files and rights of its own (user and mount namespaces)': [*_ROOM, 'true'],
    'a network of its own (network namespace)': [*_ROOM, '--unshare-net', 'true'],
    'processes of its own (PID namespace)': [
        *_ROOM, '--unshare-pid', '--unshare-ipc', '--unshare-uts', '--proc', '/proc', 'true',
    ],
    'no further namespaces in it (bwrap --disable-userns)': [
        *_ROOM, '--disable-userns', 'true',
    ],
}  # fmt: skip
_CGROUPS = (
    'Memory is counted twice a second instead, without what the kernel keeps for a submission. To '
    'get cgroups, grade as root, in a login session of systemd with cgroups of version 2, or in a '
    'container that may write to /sys/fs/cgroup'
)
_WHOLE = 'all of it together, with limits and a filter of system calls'


@dataclass(frozen=True)
class Protection:
    """One of the mechanisms that confine student code."""

    name: str
    problem: str = ''
    """Why it is missing; empty if it is available."""
    remedy: str = ''
    """How to make it available."""


@cache
def protections() -> tuple[Protection, ...]:
    """Try what a sandbox needs, one by one; stop at the first that is missing."""
    found = []
    for protection in _try_all():
        found.append(protection)
        if protection.problem:
            break
    return tuple(found)


_looking: list[threading.Thread] = []


def try_in_background() -> None:
    """Begin to try what a sandbox needs in a thread: it mostly waits for other programs."""

    def look() -> None:
        with contextlib.suppress(Exception):  # `missing_protection` tries again, and raises it
            protections()

    _looking.append(threading.Thread(target=look, name='isolation'))
    _looking[-1].start()


def missing_protection() -> str:
    """Return what is missing and how to get it, in sentences; '' if nothing is missing."""
    while _looking:
        _looking.pop().join()
    for protection in protections():
        if protection.problem:
            return (
                f'student code has no sandbox on this machine. Missing: {protection.name}: '
                f'{protection.problem}. {protection.remedy}'
            )
    return ''


def require_isolation(*, trust_students: bool = False) -> bool:
    """Return whether student code runs in a sandbox.

    Raises CourseError if it can't, unless the caller or TRUST accepts that.
    """
    problem = missing_protection()
    if problem and not (trust_students or os.environ.get(TRUST) == '1'):
        raise CourseError(
            f'nothing was run: {problem}. Or, if you would give everyone in the class your own '
            'account: ./course grade --trust-students. Each feedback page will say so.'
        )
    return not problem


def try_cgroups() -> Protection:
    """Return whether each room gets a cgroup, tried as the processes that grade would."""
    command = command_in_scope((sys.executable, '-P', '-m', 'grader.sandbox.cgroup_hierarchies'))
    tried = subprocess.run(command, capture_output=True, text=True)
    if tried.returncode == 0:
        return Protection(f'a cgroup for each room ({tried.stdout.strip()})')
    why = tried.stderr.strip().rpartition('\n')[2]
    return Protection('a cgroup for each room', why, _CGROUPS)


def reason_not_forked() -> str:
    """Return why kernels can't be forked on this machine, but are started; '' if they are forked.

    Started kernels are confined in the same way, and take longer.
    """
    with Pool(in_flight=1) as pool:
        return pool.submit(_fork_one).result()


async def _fork_one() -> str:
    sandbox = Sandbox(slot=0)
    try:
        await sandbox.open()
        paths = sandbox.paths('student')
        (await fork_into(paths, room='student', environment=paths.environment)).kill()
    except NoForkedKernel as problem:
        return str(problem)
    finally:
        await sandbox.close()
    return ''


def _try_all() -> Iterator[Protection]:
    packages = {package for tool, package in _TOOLS.items() if shutil.which(tool) is None}
    yield Protection(
        'the programs that build it',
        f'not installed: {", ".join(sorted(packages))}' if packages else '',
        f'On Debian and Ubuntu: sudo apt install {" ".join(sorted(packages))}',
    )
    said = subprocess.run(['bwrap', '--version'], capture_output=True, text=True).stdout
    version = tuple(int(part) for part in re.findall(r'\d+', said))
    yield Protection(
        'bubblewrap 0.8 or newer',
        f'this one is {said.strip() or "broken"}' if version < OLDEST_BWRAP else '',
        'Install a newer one: Debian 12 and Ubuntu 24.04 have it',
    )
    for name, command in _TRIED.items():
        tried = subprocess.run(command, capture_output=True, text=True)
        problem = tried.stderr.strip() or 'it failed' if tried.returncode else ''
        yield Protection(name, problem, remedy() if problem else '')
    problem = _try_the_whole()
    yield Protection(_WHOLE, problem, remedy() if problem else '')


def _try_the_whole() -> str:
    """Return why a program could not be run in a complete sandbox, or ''."""
    with Pool(in_flight=1) as pool:
        try:
            return pool.submit(_run_nothing).result()
        except (CourseError, OSError) as error:
            return str(error)


async def _run_nothing() -> str:
    sandbox = Sandbox(slot=0)
    try:
        await sandbox.open()
        paths = sandbox.paths('student')
        tried = subprocess.run(
            [*paths.prefix, sys.executable, '-c', ''],
            env=paths.environment,
            pass_fds=paths.pass_fds,
            capture_output=True,
            text=True,
        )
        return (tried.stderr.strip() or 'it ended') if tried.returncode else ''
    finally:
        await sandbox.close()
