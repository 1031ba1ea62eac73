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
"""The bash rcfile of terminals in JupyterLab."""
SHELL = """{'shell_command': ['bash', '-c', 'exec bash --rcfile "$COURSE_TERMINAL" -i']}"""


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Become JupyterLab. Raises LauncherError if there are no lessons, or none in that language.

    Only the lessons are served: the solutions and their nbgrader configuration are not below the
    server's root folder.
    """
    root, lessons = environment.root, environment.root / 'notebooks'
    if not lessons.is_dir():
        raise LauncherError('there is no folder notebooks/: make it with ./course release.')
    language, arguments = choose_language(lessons, variables, arguments)
    # show the workspace in the file browser, too, if it is at its default path
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
    """Return a server's options for the lessons; `settings` is JupyterLab's settings folder."""
    return [
        f'--ServerApp.root_dir={lessons}',
        f'--LabApp.default_url={first_page(language)}',
        f'--LabApp.app_settings_dir={settings}',
        f'--ServerApp.terminado_settings={SHELL}',
        # the other kernelspec in .venv is the grader's
        "--KernelSpecManager.allowed_kernelspecs={'python3'}",
        # it would warn that its configuration is missing
        "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': False}",
    ]


def first_page(language: str) -> str:
    """Return the URL path of the contents page."""
    return f'/lab/tree/{"" if language == ENGLISH else f"{language}/"}{INDEX}'


def server_variables(root: Path, lessons: Path, language: str) -> dict[str, str]:
    """Return the environment variables that a server adds for its kernels and terminals."""
    return {
        'PWD': str(lessons),
        VARIABLE: language,
        # nodes started in a terminal stay on this machine, as the notebooks' nodes do
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'COURSE_TERMINAL': str(root / TERMINAL),
    }
