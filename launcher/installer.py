"""Run uv or pip, show their progress, and explain in one sentence why they failed."""

import errno
import os
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from launcher.environment import Environment
from launcher.messages import LauncherError, clear_progress, say, show_progress
from launcher.words import gettext_noop, put

STEPS = ('Resolved ', 'Collecting ', 'Downloading ', 'Prepared ', 'Installed ')
"""How lines of an installer begin that report progress."""
FULL = (errno.ENOSPC, errno.EDQUOT)
NO_DISK = ('No space left on device', 'os error 28', 'Disk quota exceeded', 'os error 122')
NO_NETWORK: tuple[str, ...] = (
    'error sending request',
    'Failed to fetch',
    'dns error',
    'NewConnectionError',
)
NO_NETWORK += ('Failed to establish a new connection', 'Temporary failure in name resolution')
NO_NETWORK += ('Network is unreachable', 'Max retries exceeded', 'ConnectTimeout', 'ReadTimeout')
NO_NETWORK += ('Read timed out', 'ProxyError')
DISK_IS_FULL = gettext_noop(
    'the disk is full: free some space (.venv takes 0.9 GB and the downloads as much again), '
    'then start again.'
)
NETWORK_IS_AWAY = gettext_noop(
    'the package registry cannot be reached: check the network and its proxy settings, then '
    'start again.'
)
FAILED = gettext_noop('setting up failed for the reason above: fix it, then start again.')
SHOWN_LINES = 20
"""How many of an installer's last lines are shown if the cause is unknown."""


@dataclass(frozen=True)
class Installer:
    """Installs packages into a course's .venv."""

    environment: Environment
    variables: dict[str, str]
    lock: int
    """A descriptor that child processes inherit: the lock is held until the last of them ends."""
    wheels: Path | None = None
    """The folder to install everything from, without a network; None to use the network."""
    uses_uv: bool = field(init=False)

    def __post_init__(self) -> None:
        """Check that uv can be run: pyenv may have a shim for one that is not installed."""
        object.__setattr__(self, 'uses_uv', _runs(['uv', '--version'], self.variables))

    @property
    def name(self) -> str:
        """The installer's name, for messages."""
        return 'uv' if self.uses_uv else 'pip'

    def make_venv(self, python: Path) -> None:
        """Make an empty .venv. Raises LauncherError if that Python has no venv module."""
        venv = self.environment.venv
        if not self.uses_uv and not _runs(
            [python, '-c', 'import ensurepip, venv'], self.variables
        ):
            version = version_of(python)
            raise LauncherError(
                'Python {version} ({python}) has no venv module: install it (on Debian and '
                'Ubuntu: sudo apt install python{minor}-venv), then start again.',
                version=version,
                python=python,
                minor=version.rpartition('.')[0],
            )
        say(
            'setting up .venv with Python {version} and {installer} '
            '(about 0.9 GB; some minutes the first time)',
            version=version_of(python),
            installer=self.name,
        )
        with report_write_errors():
            if venv.is_dir():
                shutil.rmtree(venv)
        if self.uses_uv:
            self.run(
                'uv', 'venv', *(['--offline'] if self.wheels else []), '--python', python, venv
            )
        else:
            # in two steps: if there is no room for pip, venv alone would not show the reason
            self.run(python, '-m', 'venv', '--without-pip', venv)
            self.run(self.environment.python, '-m', 'ensurepip')

    def install(self, *arguments: str | Path) -> None:
        """Install what the arguments name, as arguments of `pip install`."""
        python = self.environment.python
        here: list[str | Path] = []
        if self.wheels:  # ignore the user's configuration, which may name other sources
            here += ['--offline', '--no-config'] if self.uses_uv else ['--isolated']
            here += ['--no-index', '--find-links', self.wheels]
        if self.uses_uv:
            command = ('uv', 'pip', 'install', '--compile-bytecode', '--python', python)
            self.run(*command, *here, *arguments)
        else:
            pip = (python, '-m', 'pip', 'install', '--disable-pip-version-check')
            options = ('--no-input', '--progress-bar', 'off')
            self.run(*pip, *options, *here, *arguments, PIP_USER='0')

    def run(self, *command: str | Path, **variables: str) -> None:
        """Run a command and show its progress. Raises LauncherError with why it failed."""
        process = subprocess.Popen(
            list(map(str, command)),
            cwd=self.environment.root,
            env=self.variables | variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            pass_fds=(self.lock,),
            text=True,
            errors='replace',
        )
        said: list[str] = []
        assert process.stdout is not None  # it is a pipe
        for line in process.stdout:
            said.append(line.rstrip('\n'))
            if step := step_of(said[-1]):
                show_progress(step)
        failed = process.wait()
        clear_progress()
        if failed:
            raise LauncherError(reason_of(said))


def step_of(line: str) -> str:
    """Return the step that a line of an installer reports, or ''."""
    if line.startswith('Installing collected packages'):
        return 'Installing'
    return line.partition(' (from ')[0] if line.startswith(STEPS) else ''


def reason_of(lines: Iterable[str]) -> str:
    """Return why an installer failed, in one sentence; after its last lines if that is unknown."""
    lines = list(lines)
    for causes, sentence in ((NO_DISK, DISK_IS_FULL), (NO_NETWORK, NETWORK_IS_AWAY)):
        if any(cause in line for line in lines for cause in causes):
            return sentence
    return '\n'.join([*lines[-SHOWN_LINES:], put(FAILED)])


@contextmanager
def report_write_errors() -> Iterator[None]:
    """Turn an OSError into a LauncherError."""
    try:
        yield
    except OSError as error:
        full = error.errno in FULL
        raise LauncherError(DISK_IS_FULL if full else f'{error}\n{put(FAILED)}') from error


def version_of(python: str | Path) -> str:
    """Return the version of a Python, such as '3.12.1', or '' if it can't be run."""
    code = 'import sys; print("%d.%d.%d" % sys.version_info[:3])'
    try:
        run = subprocess.run([python, '-ISc', code], capture_output=True, text=True)
    except OSError:
        return ''
    return '' if run.returncode else run.stdout.strip()


def _runs(command: Sequence[str | Path], variables: dict[str, str]) -> bool:
    program = shutil.which(command[0], path=variables.get('PATH', os.defpath))
    if not program:
        return False
    run = subprocess.run([program, *command[1:]], env=variables, capture_output=True)
    return run.returncode == 0
