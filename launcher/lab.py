"""`./course lab`: JupyterLab on the lessons."""

import os
import sys
from pathlib import Path

from launcher.environment import Environment
from launcher.languages import (
    ENGLISH,
    INDEX,
    VARIABLE,
    choose_language,
    jupyterlab_settings,
    languages,
)
from launcher.messages import LauncherError

TERMINAL = 'my_robot_basics/my_robot_basics/ros2/terminal.bash'
"""What a terminal in JupyterLab begins with."""
SHELL = """{'shell_command': ['bash', '-c', 'exec bash --rcfile "$COURSE_TERMINAL" -i']}"""


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Become JupyterLab. Raises LauncherError where there are no lessons, or none in a language.

    Only the lessons are served: neither the solutions nor their nbgrader configuration lie under
    the server's root.
    """
    root, lessons = environment.root, environment.root / 'notebooks'
    if not lessons.is_dir():
        raise LauncherError('there is no folder notebooks/: make it with ./course release.')
    language, arguments = choose_language(lessons, variables, arguments)
    # the file browser shows the workspace, too; where it lies elsewhere, its user knows the place
    workspace = root / 'ros_ws'
    if variables['ROS_WS'] == str(workspace) and workspace.is_dir():
        for folder in (lessons, *(lessons / each for each in languages(lessons))):
            if not os.path.lexists(folder / 'ros_ws'):
                (folder / 'ros_ws').symlink_to(os.path.relpath(workspace, folder))
    os.chdir(lessons)
    command = [str(environment.python), '-P', '-m', 'jupyterlab']
    command += options(lessons, language, jupyterlab_settings(environment, language))
    if os.getuid() == 0:
        command.append('--allow-root')
    sys.stdout.flush()
    variables |= server_variables(root, lessons, language)
    os.execve(command[0], [*command, *arguments], variables)


def options(lessons: Path, language: str, settings: Path) -> list[str]:
    """Return what a server is told that shows the lessons; `settings` is JupyterLab's folder."""
    return [
        f'--ServerApp.root_dir={lessons}',
        f'--LabApp.default_url={first_page(language)}',
        f'--LabApp.app_settings_dir={settings}',
        f'--ServerApp.terminado_settings={SHELL}',
        # the other one that .venv has is the grader's
        "--KernelSpecManager.allowed_kernelspecs={'python3'}",
        # it would warn that its configuration is missing
        "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': False}",
    ]


def first_page(language: str) -> str:
    """Return the address of the contents page."""
    return f'/lab/tree/{"" if language == ENGLISH else f"{language}/"}{INDEX}'


def server_variables(root: Path, lessons: Path, language: str) -> dict[str, str]:
    """Return the variables that a server adds for its kernels and terminals."""
    return {
        'PWD': str(lessons),
        VARIABLE: language,
        # what a terminal starts is on this machine alone, as the notebooks' nodes are
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'COURSE_TERMINAL': str(root / TERMINAL),
    }
