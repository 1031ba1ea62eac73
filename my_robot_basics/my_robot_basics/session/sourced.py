"""The startup code of each Python of .venv in a terminal in which a workspace was sourced.

`./course` links it into .venv as a module of its own, because PYTHONPATH may list the student's
copy of this package first. Imports nothing that is slow.
"""

import os
import sys
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType
from typing import Any

STARTED = '_ROS_WHEELS_BOOTSTRAP_COMPLETE'
"""The environment variable that ROS's wheels set when they restart Python with their libraries."""
LAYOUT = '.colcon_install_layout'


def start() -> None:
    """Restart Python with libraries in the order of the sourced workspaces; check packages."""
    if STARTED not in os.environ:
        _start_again()
    sys.meta_path.insert(0, Guard())


def _start_again() -> None:
    """Restart Python as ROS's wheels do, but with the library folders in a fixed order.

    The wheels take them from a set, in random order: if both a workspace and .venv have libraries
    of a package, some would be loaded from the one and some from the other.
    """
    site_packages = '{}/lib/python{}.{}/site-packages'.format(sys.prefix, *sys.version_info)
    ours = [f'{sys.prefix}/lib']
    with os.scandir(site_packages) as entries:
        ours += sorted(
            entry.path
            for entry in entries
            if entry.name.startswith('ros_') and entry.name.endswith('.libs')
        )
    given = [f for f in os.environ.get('LD_LIBRARY_PATH', '').split(os.pathsep) if f]
    built = [folder for folder in given if _is_built(folder)]
    others = [folder for folder in given if folder not in built and folder not in ours]
    os.environ['LD_LIBRARY_PATH'] = os.pathsep.join([*built, *ours, *others])
    os.environ[STARTED] = '1'
    os.execv(sys.executable, sys.orig_argv)


def _is_built(folder: str) -> bool:
    """Whether a folder is the lib/ of colcon's install/, of one package or of all merged."""
    above = os.path.dirname(folder)
    return any(os.path.exists(f'{f}/{LAYOUT}') for f in (above, os.path.dirname(above)))


class Guard:
    """Python's first import finder: refuses a package that was built wrong, and says why."""

    def __init__(self) -> None:
        self.folders = [f for f in os.environ.get('PYTHONPATH', '').split(os.pathsep) if f]

    def find_spec(
        self, name: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """Return None, so that Python uses its other finders, unless a sourced folder is gone.

        Raises ImportError for a package of interfaces in a workspace that cannot be loaded.
        """
        if path is not None or '.' in name:
            return None
        for folder in self.folders:
            if os.path.isdir(f'{folder}/{name}'):
                _check_package(folder, name)
                return None
            if f'/install/{name}/lib/' in folder and not os.path.exists(folder):
                return _find_elsewhere(folder, name)
        return None


def _check_package(folder: str, name: str) -> None:
    """Raise ImportError if the package cannot be loaded; print how it differs, if it does."""
    try:
        files = os.listdir(f'{folder}/{name}')
    except OSError as error:
        if not _is_built(os.path.dirname(os.path.dirname(folder))):
            return  # not a workspace's: Python says what it thinks of it
        raise ImportError(_overlay(folder, name).unreadable(error), name=name) from error
    if not any(file.startswith((f'{name}_s__', f'_{name}_s.')) for file in files):
        return  # not a package of interfaces
    overlay = _overlay(folder, name)
    if fault := overlay.fault():
        raise ImportError(fault, name=name)
    if difference := overlay.difference():
        _checks().say(difference)


def _overlay(folder: str, name: str) -> Any:
    """Return the package in a folder of modules, PREFIX/lib/pythonX.Y/site-packages."""
    checks = _checks()
    return checks.Overlay(checks.Path(folder).parents[2], name)


def _find_elsewhere(folder: str, name: str) -> ModuleSpec | None:
    """Find the module elsewhere, and say so; raises ModuleNotFoundError if it is nowhere."""
    checks = _checks()
    sentence = checks.gone(checks.Path(folder).parents[2])
    if found := PathFinder.find_spec(name):
        checks.say(sentence)
        return found
    raise ModuleNotFoundError(sentence, name=name)


def _checks() -> ModuleType:
    """Return the module overlays, registered under its name: a later import gets the same one."""
    name = 'my_robot_basics.session.overlays'
    if name not in sys.modules:
        file = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'overlays.py')
        spec = spec_from_file_location(name, file)
        assert spec is not None  # the file belongs to this package
        assert spec.loader is not None
        sys.modules[name] = module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]
