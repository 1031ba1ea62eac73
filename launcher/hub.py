"""`./course hub`: a student's server, started by a JupyterHub (`deploy/jupyterhub/`)."""

import json
import os
import shutil
import sys
from pathlib import Path

from launcher.environment import Environment
from launcher.lab import first_page, options, server_variables
from launcher.languages import choose_language, languages, write_settings
from launcher.messages import LauncherError

FOLDER = 'lessons'
"""In the student's home: JupyterLab's root folder. The course itself is read-only there."""
MADE = '.local/share/my_robot_basics/jupyterlab'
PAGE, DISABLED = 'page_config.json', 'disabledExtensions'
HANDS_IN = ('@jupyter/nbgrader:assignment-list', '@jupyter/nbgrader:menu')
"""Extensions to fetch, submit and read feedback. A laptop has no exchange for them."""
SERVER = 'jupyterhub'


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Become the server. Raises LauncherError if it was not started by a hub."""
    if 'JUPYTERHUB_SERVICE_URL' not in variables:
        raise LauncherError(
            'no JupyterHub has started this, expected one: ./course lab opens the lessons, and '
            'deploy/jupyterhub/README.md tells how a hub is set up.'
        )
    if not any(environment.venv.glob(f'lib/python*/site-packages/{SERVER}')):
        raise LauncherError(
            '.venv has no {package}, expected it on a hub: install deploy/jupyterhub/server.txt.',
            package=SERVER,
        )
    released, home = environment.root / 'notebooks', Path(variables['HOME'])
    language, arguments = choose_language(released, variables, arguments)
    lessons = copy_pages(released, home / FOLDER)
    variables |= server_variables(environment.root, lessons, language)
    variables['ROS_WS'] = variables['MY_ROBOT_BASICS_WORKSPACE'] = str(lessons / 'ros_ws')
    os.chdir(lessons)
    command = [str(environment.python), '-P', '-m', 'jupyterhub.singleuser']
    command += options(lessons, language, hub_settings(environment, language, home / MADE))
    # the hub redirects a student to the server's default page
    command += [f'--ServerApp.default_url={first_page(language)}', *arguments]
    sys.stdout.flush()
    os.execve(command[0], command, variables)


def copy_pages(released: Path, lessons: Path) -> Path:
    """Copy pages that are missing in a student's folder, but not lessons; return the folder.

    Lessons come through Assignment List, when the instructor has released them.
    """
    for folder in (released, *(released / each for each in languages(released))):
        target = lessons / folder.relative_to(released)
        target.mkdir(parents=True, exist_ok=True)
        for page in folder.iterdir():
            if page.is_file() and not (target / page.name).exists():
                shutil.copyfile(page, target / page.name)
    return lessons


def hub_settings(environment: Environment, language: str, folder: Path) -> Path:
    """Write JupyterLab's settings, with Assignment List, into a student's folder; return it."""
    write_settings(environment, language, folder)
    page = folder / PAGE
    settings = json.loads(page.read_text(encoding='utf-8'))
    settings[DISABLED] = [each for each in settings[DISABLED] if each not in HANDS_IN]
    page.write_text(json.dumps(settings, indent=2), encoding='utf-8')
    return folder
