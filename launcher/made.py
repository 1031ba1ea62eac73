"""What .venv was made from, and whether that is still what there is.

Each `./course` asks that first. So this knows paths as text alone: pathlib and dataclasses take
three times as long to import as everything else here.
"""

import hashlib
import os
import sys

PINS = 'environment.txt'
"""In the course's root, where installers run."""
INTERFACES = 'arm_interfaces/wheel'
"""Where the wheel of the course's own service and action lies: students have no compiler."""
TOOLS = {'ros2': 'ros2.main', 'topic_doctor': 'doctor.main', 'colcon': 'ros2.colcon'}
"""The tools and their modules: colcon, too, says in a sentence what it lacks. setup.py names the
nodes alone, which students build, too."""
UNDERLAY = r"""case :$PATH: in *:"$COLCON_CURRENT_PREFIX/bin":*) ;; *) export PATH="$COLCON_CURRENT_PREFIX/bin:$PATH" ;; esac
case :${AMENT_PREFIX_PATH:-}: in
    *:"$COLCON_CURRENT_PREFIX":*) ;;
    *) export AMENT_PREFIX_PATH="$COLCON_CURRENT_PREFIX${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}" ;;
esac
"""  # noqa: E501
"""What a workspace's setup.bash reads of the ROS that it was built on: any terminal can."""
KERNELS = "c.InteractiveShellApp.extensions.append('my_robot_basics.live.extension')\n"
"""What each IPython kernel of .venv reads at its start."""
FOREIGN_HEADERS = r'(INTERFACE_INCLUDE_DIRECTORIES) "/opt/python/[^"]*"'
"""Python's and NumPy's, where they lie on the machine that made the wheels: CMake refuses a
folder that does not exist. Whoever compiles such a part names its own Python's headers anyway."""
MODULE = 'my_robot_basics_sourced'
LINE = f"import os; os.environ.get('PYTHONPATH') and __import__('{MODULE}').start()\n"
"""What each Python of .venv runs first: `.pth` files are read by name, and that of ROS's wheels,
ros_wheels_bootstrapper.pth, starts Python again."""
WAITS = 'my_robot_basics_waits'
"""What rclpy's EventsExecutor imports, so that it can wait without end."""
ENVIRONMENT, PACKAGES = 'made_environment', 'made_packages'
"""Files in .venv that say what the packages, and what our own, were made from."""


def made_environment(root: str, version: str) -> str:
    """Return what the packages of .venv depend on; one that was moved points to where it was."""
    return f'{root}\n{version}\n{_text(root, PINS)}'


def made_packages(root: str) -> str:
    """Return what our own packages' entry in .venv depends on."""
    package = 'my_robot_basics'
    button = f'{package}/my_robot_basics/validate/labextension'
    files = [f'{package}/package.xml', *_files(root, package, begin='setup.')]
    files += _files(root, button, end='.json')
    if os.path.isdir(f'{root}/grader'):
        files += ['pyproject.toml', 'grader/kernels/kernelspec/kernel.json']
    with open(f'{root}/{interfaces_wheel(root)}', 'rb') as file:
        wheel = hashlib.sha256(file.read()).hexdigest()
    shares = [UNDERLAY, KERNELS, str(TOOLS), FOREIGN_HEADERS, LINE, WAITS]
    return ''.join([*(_text(root, name) for name in files), wheel, *shares])


def interfaces_wheel(root: str) -> str:
    """Return the path in the course of the one wheel of arm_interfaces, as installers want it.

    Raises LauncherError where it is missing, or is not the only one.
    """
    found = _files(root, INTERFACES, end='.whl')
    if len(found) != 1:
        from launcher.messages import LauncherError  # seldom needed, and longer to import

        raise LauncherError(
            '{folder}/ has {found} wheels (*.whl), expected one: get the files of the course '
            'again.',
            folder=INTERFACES,
            found=len(found),
        )
    return f'./{found[0]}'


def is_current(root: str, name: str, made: str) -> bool:
    """Whether a file of .venv says that it was made from that."""
    return os.path.isfile(f'{root}/.venv/{name}') and _text(root, f'.venv/{name}') == made


def is_set_up(root: str) -> bool:
    """Whether there is nothing to do."""
    return has_environment(root) and is_current(root, PACKAGES, made_packages(root))


def has_environment(root: str, version: str = '') -> bool:
    """Whether .venv has the packages, and that version of Python, if one is asked for."""
    python = f'{root}/.venv/bin/python'
    if not os.access(python, os.X_OK):
        return False
    its = _version(python)
    current = is_current(root, ENVIRONMENT, made_environment(root, its))
    return current and version in ('', its)


def _version(python: str) -> str:
    if sys.executable == python:  # asked by what would have to be started for it
        return '{}.{}.{}'.format(*sys.version_info[:3])
    from launcher.installer import version_of

    return version_of(python)


def _files(root: str, folder: str, *, begin: str = '', end: str = '') -> list[str]:
    """Return the files of a folder of the course whose names begin and end so, sorted."""
    path = f'{root}/{folder}'
    names = sorted(os.listdir(path)) if os.path.isdir(path) else []
    return [f'{folder}/{name}' for name in names if name.startswith(begin) and name.endswith(end)]


def _text(root: str, name: str) -> str:
    with open(f'{root}/{name}', encoding='utf-8') as file:
        return file.read()
