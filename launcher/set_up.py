"""Make `.venv`, or bring it up to date; print nothing if it is.

What it was made from is recorded in two files in it, which are written last: if one is missing or
differs, its part of the work is done again.
"""

import fcntl
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from launcher.environment import Environment
from launcher.installer import Installer, report_write_errors, version_of
from launcher.interfaces import fix_exports, fix_waits, install_startup_hook
from launcher.messages import LauncherError, say
from launcher.offline import check_wheels, offline_wheels
from launcher.shares import install_jupyter_files, make_tools, register_with_ament
from launcher.venv_inputs import (
    ENVIRONMENT,
    PACKAGES,
    PINS,
    environment_inputs,
    has_environment,
    interfaces_wheel,
    is_current,
    packages_inputs,
)

BUILD_TOOLS = ('setuptools',)
"""Packages that are needed to build those which exist only as sources."""


def record_inputs(environment: Environment, name: str, made: str) -> None:
    """Record what .venv was made from."""
    part = environment.venv / f'{name}.part'
    part.write_text(made, encoding='utf-8')
    part.rename(environment.venv / name)


def set_up(environment: Environment, python: Path) -> None:
    """Make or update .venv as far as needed. Raises LauncherError if that fails."""
    asked = version_of(python) if os.environ.get('PYTHON') else ''
    root = str(environment.root)
    if has_environment(root, asked) and is_current(root, PACKAGES, packages_inputs(root)):
        return
    if not os.access(environment.root, os.W_OK):
        raise LauncherError(
            'the folder {root} is read-only: copy the course into a folder of your own and start '
            'it there.',
            root=environment.root,
        )
    with locked(environment.root) as lock:
        wheels = offline_wheels(os.environ)
        installer = Installer(
            environment, environment.variables_for_installers(os.environ), lock, wheels
        )
        if not has_environment(root, asked):
            make_environment(installer, python)
        if not is_current(root, PACKAGES, packages_inputs(root)):
            install_packages(installer)
    say('.venv is ready')


def make_environment(installer: Installer, python: Path) -> None:
    """Make a new .venv with all pinned packages."""
    environment = installer.environment
    if python.parent == environment.python.parent:  # .venv was activated in the caller's shell
        python = Path(sys._base_executable)  # type: ignore[attr-defined]  # not in typeshed's sys
    if installer.wheels:
        check_wheels(installer.wheels, version_of(python), environment.root / PINS)
    installer.make_venv(python)
    # pip does not check hashes in its isolated build environments: install the build tools first
    pins = environment.venv / 'build_tools.txt'
    with report_write_errors():
        pins.write_text(build_tools(environment.root / PINS), encoding='utf-8')
    installer.install('-r', pins)
    installer.install('--no-deps', '--no-build-isolation', '-r', PINS)
    with report_write_errors():
        version = version_of(environment.python)
        record_inputs(environment, ENVIRONMENT, environment_inputs(str(environment.root), version))


def build_tools(pins: Path) -> str:
    """Return the part of environment.txt that pins the build tools, with hashes."""
    packages = re.split(r'^(?=\w)', pins.read_text(encoding='utf-8'), flags=re.MULTILINE)
    return ''.join(package for package in packages if package.partition('==')[0] in BUILD_TOOLS)


def install_packages(installer: Installer) -> None:
    """Install the course's own packages as editable, so that changes take effect at once."""
    environment = installer.environment
    root = str(environment.root)
    ours = ['-e', './my_robot_basics', *(['-e', '.'] if environment.has_grader else [])]
    # reinstall always: a wheel of the same version may have changed
    options = ('--no-deps', '--no-build-isolation', '--force-reinstall')
    installer.install(*options, *ours, interfaces_wheel(root))
    with report_write_errors():
        register_with_ament(environment)
        install_jupyter_files(environment)
        make_tools(environment)
        fix_exports(environment)
        fix_waits(environment)
        install_startup_hook(environment)
        record_inputs(environment, PACKAGES, packages_inputs(root))


@contextmanager
def locked(root: Path) -> Iterator[int]:
    """Lock the course's folder, so that two calls do not write to one .venv; yield the descriptor.

    The lock is released when all processes that have the descriptor end.
    """
    descriptor = os.open(root, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say('waiting for another ./course, which is setting up .venv')
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        except OSError:
            say('this file system has no locks: start one ./course at a time until .venv is ready')
        yield descriptor
    finally:
        os.close(descriptor)
