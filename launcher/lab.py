"""`./course lab`: JupyterLab on the lessons."""

import os
import sys

from launcher.environment import Environment
from launcher.messages import LauncherError

SETTINGS = '.jupyterlab'
"""They leave out the instructors' panels."""
TERMINAL = 'my_robot_basics/my_robot_basics/ros2/terminal.bash'
"""What a terminal in JupyterLab begins with."""
SHELL = """{'shell_command': ['bash', '-c', 'exec bash --rcfile "$COURSE_TERMINAL" -i']}"""


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Become JupyterLab. Raises LauncherError where there are no lessons.

    Only the lessons are served: neither the solutions nor their nbgrader configuration lie under
    the server's root.
    """
    root, lessons = environment.root, environment.root / 'notebooks'
    if not lessons.is_dir():
        raise LauncherError('there is no folder notebooks/: make it with ./course release.')
    # the file browser shows the workspace, too; where it lies elsewhere, its user knows the place
    link, workspace = lessons / 'ros_ws', root / 'ros_ws'
    shown = os.path.lexists(link)
    if variables['ROS_WS'] == str(workspace) and workspace.is_dir() and not shown:
        link.symlink_to('../ros_ws')
    os.chdir(lessons)
    command = [str(environment.python), '-P', '-m', 'jupyterlab']
    command += [
        f'--ServerApp.root_dir={lessons}',
        '--LabApp.default_url=/lab/tree/index.ipynb',
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
