"""Set up .venv, then run a verb."""

import os
import sys

from launcher.environment import Environment, ros_libraries
from launcher.messages import LauncherError, say
from launcher.verbs import Verb, read_verbs

ROOT = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
READY = '--ready'
"""Given instead of a Python if nothing has to be set up: `course` has just checked that."""


def main(arguments: list[str]) -> int:
    """Run `PYTHON VERB [ARGUMENT...]`; return the exit status.

    PYTHON is the interpreter for a new `.venv`, or READY.
    """
    environment = Environment(ROOT)
    python, name, *rest = arguments
    try:
        if python != READY:
            from pathlib import Path

            from launcher.set_up import set_up  # imports the installers, which are rarely needed

            set_up(environment, Path(python))
        return run_verb(environment, read_verbs()[name], rest)
    except LauncherError as error:
        say(str(error))
        return 1
    except KeyboardInterrupt:
        return 130


def run_verb(environment: Environment, verb: Verb, arguments: list[str]) -> int:
    """Run a verb in its folder; return the exit status, unless this process is replaced by it."""
    variables = environment.variables(os.environ)
    if verb.owner == 'everyone':
        from launcher.languages import VARIABLE, language_of_locale, replaced_locale

        lessons = environment.root / 'notebooks'
        variables.setdefault(VARIABLE, language_of_locale(lessons, variables))
        variables |= replaced_locale(variables)
    else:
        variables.pop('COURSE_LANGUAGE', None)  # set in a terminal; grading is always in English
    if verb.folder == 'root':
        os.chdir(environment.folder)
        variables['PWD'] = environment.folder
    if verb.runs.startswith('launcher.'):
        import importlib

        return importlib.import_module(verb.runs).run(environment, variables, arguments)
    command = [f'{environment.folder}/.venv/bin/python', '-P', '-m', *verb.runs.split()]
    command += arguments
    if sys.executable == command[0]:  # this process is that Python
        variables |= ros_libraries(f'{environment.folder}/.venv', variables)
    sys.stdout.flush()
    os.execve(command[0], command, variables)
