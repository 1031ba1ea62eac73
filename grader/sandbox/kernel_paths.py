"""Where a kernel lives: its folders, what its process is told, and how its command begins."""

import json
import os
import shutil
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from grader.sandbox.temporary_folders import own_folder

_PASSED_ON: tuple[str, ...] = ('LANG', 'LC_ALL', 'TZ')
# the ROS wheels start an interpreter anew to set the one, unless they find the other
_PASSED_ON += ('LD_LIBRARY_PATH', '_ROS_WHEELS_BOOTSTRAP_COMPLETE')
_ALWAYS = {
    'MPLBACKEND': 'module://matplotlib_inline.backend_inline',
    'PYTHONSAFEPATH': '1',
    'PYTHONDONTWRITEBYTECODE': '1',
    # a set of texts has one order then, in every grading: {'joint1', 'joint2'} begins with joint2
    'PYTHONHASHSEED': '3',
}


_LAUNCHER = (
    Path(__file__).parents[1].joinpath('kernels', 'forkserver', 'offline.py').read_text('utf-8')
    + """

keep_off_the_network()
import runpy
runpy.run_module('ipykernel_launcher', run_name='__main__', alter_sys=True)
"""
)


@dataclass(frozen=True)
class Keeper:
    """A process that keeps a room, so that one which was forked elsewhere can join it there."""

    command: tuple[str, ...]
    """Says a line when the room is built."""
    pass_fds: tuple[int, ...]
    info_fd: int
    """The file descriptor where bubblewrap tells about it."""
    user: int | None
    """Whom root becomes before it joins."""
    entrances: tuple[Path, ...] = ()
    """Where it joins the room's cgroup, before all else."""


@dataclass(frozen=True)
class KernelPaths:
    """Where one kernel lives: what it is `given`, its sockets in `kernel`, its own in `home`."""

    folder: Path
    """The grader's folder for it; it holds `given`."""
    sockets: Path
    """The kernel's sockets as the grader reaches them."""
    inside: Path
    """What holds `given`, `kernel` and `home`, as the kernel's process knows it."""
    prefix: tuple[str, ...] = ()
    """How a command begins that runs there."""
    environment: dict[str, str] = field(default_factory=dict)
    """What its process is told, beside what every kernel is."""
    pass_fds: tuple[int, ...] = ()
    """What `prefix` reads."""
    made: Path | None = None
    """Where a room's kernel makes its sockets, and may make something else of them later."""
    keeper: Keeper | None = None
    """Where a forked kernel can join."""

    @property
    def sandboxed(self) -> bool:
        """Whether what runs there has neither the rights nor the network of the grading user."""
        return bool(self.prefix)

    @property
    def files(self) -> Path:
        """The folder of modules that are given to it."""
        return self.folder / 'given' / 'files'

    @property
    def packages(self) -> Path:
        """The folder of ROS packages that are given to it."""
        return self.folder / 'given' / 'packages'

    def kernel_command(self) -> list[str]:
        """Return the command of a kernel, as its process knows it."""
        launcher = [sys.executable, '-c', _LAUNCHER, '-f']
        options = ['--InteractiveShellApp.ignore_cwd=True', '--HistoryManager.enabled=False']
        connection = str(self.inside / 'given' / 'connection.json')
        return [*launcher, connection, *options]

    def command(self) -> list[str]:
        """Return the command of a kernel that lives there."""
        return [*self.prefix, *self.kernel_command()]

    def write_connection_file(self, connection_file: Path) -> None:
        """Write the kernel's own connection file: it may know its sockets by another path."""
        connection = json.loads(connection_file.read_text(encoding='utf-8'))
        connection['ip'] = str(self.inside / 'kernel' / 'zmq')
        inside = self.folder / 'given' / 'connection.json'
        inside.write_text(json.dumps(connection), encoding='utf-8')

    def remove(self) -> None:
        """Remove the grader's folder."""
        shutil.rmtree(self.folder, ignore_errors=True)


def make_folder(name: str) -> Path:
    """Make a temporary folder that nobody else can enter, with an empty `given` in it."""
    folder = Path(tempfile.mkdtemp(prefix=f'{name}-', dir=own_folder()))
    (folder / 'given' / 'files').mkdir(parents=True)
    (folder / 'given' / 'packages').mkdir()
    return folder


def make_paths(room: str) -> KernelPaths:
    """Return the paths of a kernel with the rights and the network of the grading user."""
    folder = make_folder(room)
    (folder / 'kernel').mkdir()
    (folder / 'home' / 'work').mkdir(parents=True)
    names = ('PATH', 'HOME', 'TMPDIR', 'AMENT_PREFIX_PATH')
    environment = {name: os.environ[name] for name in names if name in os.environ}
    return KernelPaths(folder, folder / 'kernel', inside=folder, environment=environment)


def passed_on() -> dict[str, str]:
    """Return what every Python of the grader's is told, wherever it lives."""
    environment = {name: os.environ[name] for name in _PASSED_ON if name in os.environ}
    return environment | _ALWAYS


def environment_of(
    paths: KernelPaths, *, room: str, domain_id: int, seed: str = ''
) -> dict[str, str]:
    """Return what a kernel's process is told: nothing of the caller's own, but where things are.

    Only the test room is told the seed.
    """
    home = paths.inside / 'home'
    environment = passed_on()
    environment |= paths.environment | {
        'MY_ROBOT_BASICS_ROOM': room,
        'MY_ROBOT_BASICS_DOMAIN_ID': str(domain_id),
        'RCUTILS_LOGGING_USE_STDOUT': '1',
        'ROS_LOG_DIR': str(home / 'ros_log'),
        'IPYTHONDIR': str(home / 'ipython'),
    }
    if room == 'test':
        environment['MY_ROBOT_BASICS_SEED'] = seed
    else:
        environment['MY_ROBOT_BASICS_PACKAGES'] = str(paths.inside / 'given' / 'packages')
        environment['MY_ROBOT_BASICS_WORKSPACE'] = str(home / 'ros_ws')
    return environment
