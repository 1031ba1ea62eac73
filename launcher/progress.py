"""`./course progress`: the progress that the contents page shows, in a terminal."""

import os
import sys

from launcher.environment import Environment
from launcher.lab import ENGLISH, INDEX, choose_language
from launcher.messages import LauncherError


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Become the program that prints it. Raises LauncherError if there are no lessons."""
    lessons = environment.root / 'notebooks'
    if not lessons.is_dir():
        raise LauncherError('there is no folder notebooks/: make it with ./course release.')
    language, arguments = choose_language(lessons, variables, arguments)
    page = lessons / ('' if language == ENGLISH else language) / INDEX
    command = [str(environment.python), '-P', '-m', 'my_robot_basics.validate.progress.progress']
    command += [str(page), *arguments]
    sys.stdout.flush()
    os.execve(command[0], command, variables)
