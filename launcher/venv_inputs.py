"""What .venv was made from, and whether it is up to date.

Each `./course` checks that first, so it must be fast. Paths are strings here: to import pathlib
and dataclasses takes three times as long as all the rest.
"""

import os
import sys
import zlib

PINS = 'environment.txt'
"""In the course's root folder, from which installers run."""
INTERFACES = 'arm_interfaces/wheel'
"""The folder with the wheel of the course's own interfaces: students have no compiler."""
TOOLS = {'ros2': 'ros2.main', 'topic_doctor': 'doctor.main', 'colcon': 'ros2.colcon'}
"""The tools and their modules; colcon is wrapped so that it explains what is missing. setup.py
lists only the nodes, because students build it, too."""
UNDERLAY = r"""case :$PATH: in *:"$COLCON_CURRENT_PREFIX/bin":*) ;; *) export PATH="$COLCON_CURRENT_PREFIX/bin:$PATH" ;; esac
case :${AMENT_PREFIX_PATH:-}: in
    *:"$COLCON_CURRENT_PREFIX":*) ;;
    *) export AMENT_PREFIX_PATH="$COLCON_CURRENT_PREFIX${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}" ;;
esac
"""  # noqa: E501
"""What a workspace's setup.bash sources as its underlay: any shell can run it."""
KERNELS = "c.InteractiveShellApp.extensions.append('my_robot_basics.live.extension')\n"
"""The configuration of each IPython kernel of .venv."""
SAFE_PATH = '-P'
"""Python's option with which a kernel imports nothing from the notebook's folder at its start:
else opening a notebook of somebody else would run a file `ipykernel_launcher.py` beside it."""
FOREIGN_HEADERS = r'(INTERFACE_INCLUDE_DIRECTORIES) "/opt/python/[^"]*"'
"""Header paths of Python and NumPy on the machine that built the wheels: CMake refuses folders
that do not exist. A build of such a part adds its own Python's headers anyway."""
MODULE = 'my_robot_basics_sourced'
LINE = f"import os; os.environ.get('PYTHONPATH') and __import__('{MODULE}').start()\n"
"""What each Python of .venv runs first. `.pth` files are read in the order of their names, and
ros_wheels_bootstrapper.pth, of the ROS wheels, restarts Python."""
WAITS = 'my_robot_basics_waits'
"""A module that is imported with rclpy's EventsExecutor, so that it can wait without a timeout."""
ENVIRONMENT, PACKAGES = 'made_environment', 'made_packages'
"""Files in .venv that record what the packages, and our own packages, were made from."""


def environment_inputs(root: str, version: str) -> str:
    """Return what .venv depends on; it includes the path, because a moved .venv does not work."""
    return f'{root}\n{version}\n{_text(root, PINS)}'


def packages_inputs(root: str) -> str:
    """Return what the installation of our own packages in .venv depends on."""
    package = 'my_robot_basics'
    button = f'{package}/my_robot_basics/validate/labextension'
    files = [f'{package}/package.xml', *_files(root, package, begin='setup.')]
    files += _files(root, button, end='.json')
    if os.path.isdir(f'{root}/grader'):
        files += ['pyproject.toml', 'grader/kernels/kernelspec/kernel.json']
    with open(f'{root}/{interfaces_wheel(root)}', 'rb') as file:
        wheel = f'{zlib.crc32(file.read()):08x}'  # hashlib takes longer to import
    shares = [UNDERLAY, KERNELS, SAFE_PATH, str(TOOLS), FOREIGN_HEADERS, LINE, WAITS]
    return ''.join([*(_text(root, name) for name in files), wheel, *shares])


def interfaces_wheel(root: str) -> str:
    """Return the relative path of the wheel of arm_interfaces, as installers expect it.

    Raises LauncherError if there is no wheel, or more than one.
    """
    found = _files(root, INTERFACES, end='.whl')
    if len(found) != 1:
        from launcher.messages import LauncherError  # rarely needed, and slow to import

        raise LauncherError(
            '{folder}/ has {found} wheels (*.whl), expected one: get the files of the course '
            'again.',
            folder=INTERFACES,
            found=len(found),
        )
    return f'./{found[0]}'


def is_current(root: str, name: str, made: str) -> bool:
    """Whether a file in .venv has this content, which records what it was made from."""
    return os.path.isfile(f'{root}/.venv/{name}') and _text(root, f'.venv/{name}') == made


def is_set_up(root: str) -> bool:
    """Whether .venv is up to date."""
    return has_environment(root) and is_current(root, PACKAGES, packages_inputs(root))


def has_environment(root: str, version: str = '') -> bool:
    """Whether .venv has the pinned packages, and this version of Python if one is given."""
    python = f'{root}/.venv/bin/python'
    if not os.access(python, os.X_OK):
        return False
    its = _version(python)
    current = is_current(root, ENVIRONMENT, environment_inputs(root, its))
    return current and version in ('', its)


def _version(python: str) -> str:
    if sys.executable == python:  # this process is that Python: no need to start it
        return '{}.{}.{}'.format(*sys.version_info[:3])
    from launcher.installer import version_of

    return version_of(python)


def _files(root: str, folder: str, *, begin: str = '', end: str = '') -> list[str]:
    """Return the files in a folder of the course with this beginning and end, sorted."""
    path = f'{root}/{folder}'
    names = sorted(os.listdir(path)) if os.path.isdir(path) else []
    return [f'{folder}/{name}' for name in names if name.startswith(begin) and name.endswith(end)]


def _text(root: str, name: str) -> str:
    with open(f'{root}/{name}', encoding='utf-8') as file:
        return file.read()
