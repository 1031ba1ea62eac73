"""The paths of the course and its `.venv`, and the environment variables for what runs in it.

Each `./course VERB` reads them, and pathlib takes longer to import than all the rest: so the
variables are made of paths as text, and a Path is made for who asks for one.
"""

import os
import sys

TYPE_CHECKING = False  # typing's own: to import that takes as long as pathlib
if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

FOREIGN: tuple[str, ...] = (
    'PYTHONPATH',
    'PYTHONHOME',
    'PYTHONSTARTUP',
    'PYTHONUSERBASE',
    'VIRTUAL_ENV',
)
FOREIGN += (
    'CONDA_PREFIX',
    'PIP_TARGET',
    'PIP_PREFIX',
    'PIP_ROOT',
    'UV_SYSTEM_PYTHON',
    'UV_PYTHON',
)
FOREIGN += ('AMENT_PREFIX_PATH', 'COLCON_PREFIX_PATH', 'CMAKE_PREFIX_PATH')
FOREIGN += ('ROS_DISTRO', 'ROS_VERSION', 'ROS_PYTHON_VERSION', 'ROS_DOMAIN_ID')
FOREIGN += ('ROS_LOCALHOST_ONLY', 'ROS_DISCOVERY_SERVER', 'ROS_STATIC_PEERS')
FOREIGN += ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_SECURITY_ENABLE', 'RMW_IMPLEMENTATION')
FOREIGN += ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE')
FOREIGN += ('FASTDDS_BUILTIN_TRANSPORTS', 'RCUTILS_CONSOLE_OUTPUT_FORMAT')
FOREIGN += ('_ROS_WHEELS_BOOTSTRAP_COMPLETE',)
"""Variables of the user's Python and of another ROS installation, which would affect .venv."""
PREFIXES = ('AMENT_PREFIX_PATH', 'COLCON_PREFIX_PATH', 'CMAKE_PREFIX_PATH')
"""Variables that list the prefixes of a ROS installation sourced in the caller's shell."""


class Environment:
    """A checkout of the course, or a student's bundle, with its `.venv`."""

    def __init__(self, root: 'str | Path') -> None:
        """Take the root folder."""
        self.folder = str(root)
        """Its path as text."""

    @property
    def root(self) -> 'Path':
        """The root folder."""
        from pathlib import Path

        return Path(self.folder)

    @property
    def venv(self) -> 'Path':
        """The virtual environment in which everything is installed."""
        return self.root / '.venv'

    @property
    def python(self) -> 'Path':
        """The Python that runs the verbs."""
        return self.venv / 'bin/python'

    @property
    def has_grader(self) -> bool:
        """Whether this is the whole course: a bundle has no grader."""
        return (self.root / 'grader').is_dir()

    def variables_for_installers(self, variables: 'Mapping[str, str]') -> dict[str, str]:
        """Return the caller's variables without those of other environments, for installers."""
        foreign = {f'{self.folder}/.venv', '/opt/ros'}
        for name in PREFIXES:
            foreign.update(filter(None, variables.get(name, '').split(os.pathsep)))
        kept = {name: value for name, value in variables.items() if name not in FOREIGN}
        for name in ('PATH', 'LD_LIBRARY_PATH'):
            kept[name] = without_foreign(kept.get(name, ''), foreign)
        if not kept['LD_LIBRARY_PATH']:
            del kept['LD_LIBRARY_PATH']
        return kept

    def variables(self, variables: 'Mapping[str, str]') -> dict[str, str]:
        """Return the environment variables for a verb."""
        inside, venv = self.variables_for_installers(variables), f'{self.folder}/.venv'
        inside |= {
            'VIRTUAL_ENV': venv,
            'PATH': os.pathsep.join(filter(None, [f'{venv}/bin', inside['PATH']])),
            'AMENT_PREFIX_PATH': venv,
            'RCUTILS_LOGGING_USE_STDOUT': '1',
            'RCUTILS_COLORIZED_OUTPUT': '0',
            # a kernelspec python3 in the user's home must not replace ours
            'JUPYTER_PREFER_ENV_PATH': '1',
            # ROS tutorials use this name, too, for the user's own workspace
            'ROS_WS': variables.get('MY_ROBOT_BASICS_WORKSPACE') or f'{self.folder}/ros_ws',
        }
        if ' ' in venv:
            # colcon's setup.bash fails if its Python's path has a space; it works with any Python
            inside['COLCON_PYTHON_EXECUTABLE'] = str(self.python.resolve())
        return inside


def without_foreign(folders: str, foreign: set[str]) -> str:
    """Return a list of folders without those inside a foreign prefix."""
    kept = []
    for folder in filter(None, folders.split(os.pathsep)):
        above = [folder, folder.rstrip('/')]
        while above[-1] not in ('', '/'):
            above.append(os.path.dirname(above[-1]))
        if not foreign.intersection(above):
            kept.append(folder)
    return os.pathsep.join(kept)


def ros_libraries(venv: str, variables: 'Mapping[str, str]') -> dict[str, str]:
    """Return the variables that ROS's wheels would otherwise start a verb's Python again to set.

    They are for the Python of `.venv` that runs this: its version is in the path. The folders have
    a fixed order, as `session/sourced.py` gives them; the wheels take them from a set.
    """
    packages = '{}/lib/python{}.{}/site-packages'.format(venv, *sys.version_info)
    names = sorted(os.listdir(packages))
    libraries = [name for name in names if name.startswith('ros_') and name.endswith('.libs')]
    folders = [f'{venv}/lib', *(os.path.realpath(f'{packages}/{name}') for name in libraries)]
    folders += filter(None, variables.get('LD_LIBRARY_PATH', '').split(os.pathsep))
    return {
        'LD_LIBRARY_PATH': os.pathsep.join(folders),
        '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1',
    }
