"""`./course lab`: JupyterLab on the lessons."""

import os
import sys
from collections.abc import Mapping
from pathlib import Path

from launcher.environment import Environment
from launcher.messages import LauncherError

SETTINGS = '.jupyterlab'
"""They leave out the instructors' panels."""
TERMINAL = 'my_robot_basics/my_robot_basics/ros2/terminal.bash'
"""What a terminal in JupyterLab begins with."""
SHELL = """{'shell_command': ['bash', '-c', 'exec bash --rcfile "$COURSE_TERMINAL" -i']}"""
INDEX = 'index.ipynb'
ENGLISH = 'en'
OPTION = '--language'


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
    command += [
        f'--ServerApp.root_dir={lessons}',
        f'--LabApp.default_url=/lab/tree/{"" if language == ENGLISH else f"{language}/"}{INDEX}',
        f'--LabApp.app_settings_dir={root / SETTINGS}',
        f'--ServerApp.terminado_settings={SHELL}',
        # it would warn that its configuration is missing
        "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': False}",
        *(['--allow-root'] if os.getuid() == 0 else []),
        *arguments,
    ]
    variables |= {
        'PWD': str(lessons),
        # what a terminal starts is on this machine alone, as the notebooks' nodes are
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'COURSE_TERMINAL': str(root / TERMINAL),
    }
    sys.stdout.flush()
    os.execve(command[0], command, variables)


def choose_language(
    lessons: Path, variables: Mapping[str, str], arguments: list[str]
) -> tuple[str, list[str]]:
    """Return the language of the lessons to open, and the arguments without the one that names it.

    `--language zh_CN` chooses, or else the user's locale does where there is such an edition.
    Raises LauncherError where there is none of that name.
    """
    known = [ENGLISH, *languages(lessons)]
    kept, asked = [], ''
    rest = iter(arguments)
    for argument in rest:
        name, found, value = argument.partition('=')
        if name != OPTION:
            kept.append(argument)
        else:
            asked = value if found else next(rest, '')
            if asked not in known:
                raise LauncherError(
                    f'there are no lessons in {asked!r}: {OPTION} takes {" or ".join(known)}.'
                )
    return asked or _of_the_locale(known, variables), kept


def languages(lessons: Path) -> list[str]:
    """Return the languages, other than English, in which there are lessons."""
    return sorted(page.parent.name for page in lessons.glob(f'*/{INDEX}'))


def _of_the_locale(known: list[str], variables: Mapping[str, str]) -> str:
    """Return the edition that fits the user's locale best: zh_CN, or another Chinese one."""
    said = (variables.get(name) for name in ('LC_ALL', 'LC_MESSAGES', 'LANG'))
    locale = next(filter(None, said), '').partition('.')[0].partition('@')[0]
    alike = [each for each in known if each.split('_')[0] == locale.split('_')[0]]
    return locale if locale in known else next(iter(alike), ENGLISH)
