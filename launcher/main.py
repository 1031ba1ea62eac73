"""Set up, then run a verb."""

import importlib
import os
import sys
from pathlib import Path

from launcher.environment import Environment
from launcher.languages import VARIABLE, of_the_locale, replaced_locale
from launcher.messages import LauncherError, say
from launcher.set_up import is_set_up, set_up
from launcher.verbs import Verb, read_verbs

ROOT = Path(__file__).resolve().parents[1]


def main(arguments: list[str]) -> int:
    """Run `--is-set-up`, or `PYTHON VERB [ARGUMENT...]`; return the exit status.

    PYTHON is the interpreter that a new `.venv` would be made with.
    """
    environment = Environment(ROOT)
    if arguments == ['--is-set-up']:
        return 0 if is_set_up(environment) else 1
    python, name, *rest = arguments
    try:
        set_up(environment, Path(python))
        return run_verb(environment, read_verbs()[name], rest)
    except LauncherError as error:
        say(str(error))
        return 1
    except KeyboardInterrupt:
        return 130


def run_verb(environment: Environment, verb: Verb, arguments: list[str]) -> int:
    """Run a verb in its folder; return the exit status, if this process does not become it."""
    variables = environment.variables(os.environ)
    if verb.owner == 'everyone':
        lessons = environment.root / 'notebooks'
        variables.setdefault(VARIABLE, of_the_locale(lessons, variables))
        variables |= replaced_locale(variables)
    else:
        variables.pop(VARIABLE, None)  # a terminal's: what grades speaks English
    if verb.folder == 'root':
        os.chdir(environment.root)
        variables['PWD'] = str(environment.root)
    if verb.runs.startswith('launcher.'):
        return importlib.import_module(verb.runs).run(environment, variables, arguments)
    command = [str(environment.python), '-P', '-m', *verb.runs.split(), *arguments]
    sys.stdout.flush()
    os.execve(command[0], command, variables)
