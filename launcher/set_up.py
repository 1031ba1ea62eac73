"""Make `.venv`, or bring it up to date; say nothing where it is.

What it was made from is kept inside it, in two files that are written last: where one is missing
or tells of something else, its part of the work is done again.
"""

import fcntl
import hashlib
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from launcher.environment import Environment
from launcher.installer import Installer, version_of, writing
from launcher.interfaces import FOREIGN_HEADERS, LINE, fix_exports, tell_python
from launcher.messages import LauncherError, say
from launcher.offline import asked_for, check_wheels
from launcher.shares import KERNELS, TOOLS, UNDERLAY, make_tools, tell_ament, tell_jupyter

PINS = 'environment.txt'
"""In the course's root, where installers run."""
INTERFACES = 'arm_interfaces/wheel'
"""Where the wheel of the course's own service and action lies: students have no compiler."""
BUILD_TOOLS = ('setuptools',)
"""What the packages are built with that exist as sources alone."""


def made_environment(environment: Environment) -> str:
    """Return what the packages of .venv depend on; one that was moved points to where it was."""
    pins = (environment.root / PINS).read_text(encoding='utf-8')
    return f'{environment.root}\n{version_of(environment.python)}\n{pins}'


def made_packages(environment: Environment) -> str:
    """Return what our own packages' entry in .venv depends on."""
    root = environment.root
    package = root / 'my_robot_basics'
    files = [package / 'package.xml', *sorted(package.glob('setup.*'))]
    files += sorted((package / 'my_robot_basics/validate/labextension').glob('*.json'))
    if environment.has_grader:
        files += [root / 'pyproject.toml', root / 'grader/kernels/kernelspec/kernel.json']
    texts = [file.read_text(encoding='utf-8') for file in files]
    wheel = hashlib.sha256((root / interfaces_wheel(root)).read_bytes()).hexdigest()
    shares = [UNDERLAY, KERNELS, str(TOOLS), FOREIGN_HEADERS.pattern, LINE]
    return ''.join([*texts, wheel, *shares])


def interfaces_wheel(root: Path) -> str:
    """Return the path in the course of the one wheel of arm_interfaces, as installers want it.

    Raises LauncherError where it is missing, or is not the only one.
    """
    found = sorted((root / INTERFACES).glob('*.whl'))
    if len(found) != 1:
        raise LauncherError(
            '{folder}/ has {found} wheels (*.whl), expected one: get the files of the course '
            'again.',
            folder=INTERFACES,
            found=len(found),
        )
    return f'./{found[0].relative_to(root)}'


Made = Callable[[Environment], str]


def is_current(environment: Environment, made: Made) -> bool:
    """Whether .venv was made from what there is now."""
    remembered = environment.venv / made.__name__
    return remembered.is_file() and remembered.read_text(encoding='utf-8') == made(environment)


def remember(environment: Environment, made: Made) -> None:
    """Write down what .venv was made from."""
    part = environment.venv / f'{made.__name__}.part'
    part.write_text(made(environment), encoding='utf-8')
    part.rename(environment.venv / made.__name__)


def is_set_up(environment: Environment) -> bool:
    """Whether there is nothing to do."""
    return has_environment(environment) and is_current(environment, made_packages)


def has_environment(environment: Environment, version: str = '') -> bool:
    """Whether .venv has the packages, and that version of Python, if one is asked for."""
    if not os.access(environment.python, os.X_OK) or not is_current(environment, made_environment):
        return False
    return not version or version_of(environment.python) == version


def set_up(environment: Environment, python: Path) -> None:
    """Make all of .venv that is missing. Raises LauncherError where that cannot be done."""
    asked = version_of(python) if os.environ.get('PYTHON') else ''
    if has_environment(environment, asked) and is_current(environment, made_packages):
        return
    if not os.access(environment.root, os.W_OK):
        raise LauncherError(
            'the folder {root} is read-only: copy the course into a folder of your own and start '
            'it there.',
            root=environment.root,
        )
    with locked(environment.root) as lock:
        wheels = asked_for(os.environ)
        installer = Installer(environment, environment.outside(os.environ), lock, wheels)
        if not has_environment(environment, asked):
            make_environment(installer, python)
        if not is_current(environment, made_packages):
            install_packages(installer)
    say('.venv is ready')


def make_environment(installer: Installer, python: Path) -> None:
    """Make a new .venv with every package that is pinned."""
    environment = installer.environment
    if python.parent == environment.python.parent:  # .venv was activated in the caller's shell
        python = Path(sys._base_executable)  # type: ignore[attr-defined]  # not in typeshed's sys
    if installer.wheels:
        check_wheels(installer.wheels, version_of(python), environment.root / PINS)
    installer.make_venv(python)
    # pip's own environments for builds know of no hashes, so that the tools must be here before
    pins = environment.venv / 'build_tools.txt'
    with writing():
        pins.write_text(build_tools(environment.root / PINS), encoding='utf-8')
    installer.install('-r', pins)
    installer.install('--no-deps', '--no-build-isolation', '-r', PINS)
    with writing():
        remember(environment, made_environment)


def build_tools(pins: Path) -> str:
    """Return the part of environment.txt that pins the tools, with its hashes."""
    packages = re.split(r'^(?=\w)', pins.read_text(encoding='utf-8'), flags=re.MULTILINE)
    return ''.join(package for package in packages if package.partition('==')[0] in BUILD_TOOLS)


def install_packages(installer: Installer) -> None:
    """Install the course's own packages: editable, so that a change holds at once."""
    environment = installer.environment
    ours = ['-e', './my_robot_basics', *(['-e', '.'] if environment.has_grader else [])]
    # by force: a wheel of the same version may hold something else by now
    options = ('--no-deps', '--no-build-isolation', '--force-reinstall')
    installer.install(*options, *ours, interfaces_wheel(environment.root))
    with writing():
        tell_ament(environment)
        tell_jupyter(environment)
        make_tools(environment)
        fix_exports(environment)
        tell_python(environment)
        remember(environment, made_packages)


@contextmanager
def locked(root: Path) -> Iterator[int]:
    """Lock the course's folder, so that two calls do not write one .venv; yield the descriptor.

    The lock goes with the processes that hold it.
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
