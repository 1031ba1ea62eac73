"""A kernel's place: its folders, the environment of its process, the start of its command."""

import json
import os
import shutil
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from grader.sandbox.temporary_folders import own_folder

_PASSED_ON: tuple[str, ...] = ('LANG', 'LC_ALL', 'TZ')
# without the second, the ROS wheels restart the interpreter to set the first
_PASSED_ON += ('LD_LIBRARY_PATH', '_ROS_WHEELS_BOOTSTRAP_COMPLETE')
_ALWAYS = {
    'MPLBACKEND': 'module://matplotlib_inline.backend_inline',
    'PYTHONSAFEPATH': '1',
    'PYTHONDONTWRITEBYTECODE': '1',
    # fixes the order of a set of strings in every grading: {'joint1', 'joint2'} begins with joint2
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
    """A process that keeps a room open, so that a process forked elsewhere can join the room."""

    command: tuple[str, ...]
    """It prints a line when the room is built."""
    pass_fds: tuple[int, ...]
    info_fd: int
    """The file descriptor to which bubblewrap writes the first process's ID."""
    user: int | None
    """The user ID that root takes before it joins; None if it keeps its own."""
    entrances: tuple[Path, ...] = ()
    """The files through which a process joins the room's cgroup, before anything else."""


@dataclass(frozen=True)
class KernelPaths:
    """One kernel's folders: `given` is for it to read, `kernel` for sockets, `home` its own."""

    folder: Path
    """The grader's folder for this kernel; it contains `given`."""
    sockets: Path
    """The folder through which the grader reaches the kernel's sockets."""
    inside: Path
    """The folder of `given`, `kernel` and `home`, as the kernel's process sees it."""
    prefix: tuple[str, ...] = ()
    """The beginning of a command that runs in the room; empty without a sandbox."""
    environment: dict[str, str] = field(default_factory=dict)
    """Variables for the kernel's process, in addition to those that every kernel has."""
    pass_fds: tuple[int, ...] = ()
    """File descriptors that `prefix` reads."""
    made: Path | None = None
    """Where a sandboxed kernel creates its sockets; student code can replace them later."""
    keeper: Keeper | None = None
    """What keeps the room open, so that a forked kernel can join it."""

    @property
    def sandboxed(self) -> bool:
        """Whether the kernel has neither the rights nor the network of the grading user."""
        return bool(self.prefix)

    @property
    def files(self) -> Path:
        """The folder of Python modules that the kernel is given."""
        return self.folder / 'given' / 'files'

    @property
    def packages(self) -> Path:
        """The folder of ROS packages that the kernel is given."""
        return self.folder / 'given' / 'packages'

    def kernel_command(self) -> list[str]:
        """Return the kernel's command, with paths as the kernel's process sees them."""
        launcher = [sys.executable, '-c', _LAUNCHER, '-f']
        options = ['--InteractiveShellApp.ignore_cwd=True', '--HistoryManager.enabled=False']
        connection = str(self.inside / 'given' / 'connection.json')
        return [*launcher, connection, *options]

    def command(self) -> list[str]:
        """Return the whole command that starts a kernel in the room."""
        return [*self.prefix, *self.kernel_command()]

    def write_connection_file(self, connection_file: Path) -> None:
        """Write the kernel's own connection file, with the path at which it sees its sockets."""
        connection = json.loads(connection_file.read_text(encoding='utf-8'))
        connection['ip'] = str(self.inside / 'kernel' / 'zmq')
        inside = self.folder / 'given' / 'connection.json'
        inside.write_text(json.dumps(connection), encoding='utf-8')

    def remove(self) -> None:
        """Remove the grader's folder."""
        shutil.rmtree(self.folder, ignore_errors=True)


def make_folder(name: str) -> Path:
    """Make a temporary folder that other users can't enter, with an empty `given` in it."""
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


def inherited_variables() -> dict[str, str]:
    """Return the variables that every Python process of the grader gets, in a room or not."""
    environment = {name: os.environ[name] for name in _PASSED_ON if name in os.environ}
    return environment | _ALWAYS


def environment_of(
    paths: KernelPaths, *, room: str, domain_id: int, seed: str = ''
) -> dict[str, str]:
    """Return a kernel's environment: nothing private of the caller's, but where files are.

    Only the test room gets the seed.
    """
    home = paths.inside / 'home'
    environment = inherited_variables()
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
