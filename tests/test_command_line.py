"""Commands import no heavy module early; unlike times, this does not depend on the machine."""

import json
import subprocess
import sys

import pytest
from course_maker import TOY, released_course, submit

from grader.__main__ import main
from grader.cli.arguments import make_parser
from grader.common.argument_values import PLATFORMS
from grader.course import ROOT
from grader.passback.write import TABLES
from grader.storage.lesson_checksums import FOLDER

HEAVY = {
    *('IPython', 'alembic', 'babel', 'bleach', 'bs4', 'dask', 'distributed', 'jinja2'),
    *('jsonschema', 'jupyter_client', 'jupyter_server', 'matplotlib', 'nbclient', 'nbconvert'),
    *('nbformat', 'nbgrader', 'numpy', 'psutil', 'rclpy', 'requests', 'setuptools', 'sqlalchemy'),
    *('tornado', 'traitlets', 'wcwidth', 'yaml', 'zmq'),
}
"""Packages of which each takes 10 ms and more, or brings another one of them."""
SLOW_TO_START = {'asyncio', 'dataclasses', 'inspect', 'logging', 'subprocess', 'tempfile'}
"""Modules of the standard library of which each takes 5 ms and more."""
OF_THE_LAUNCHER = SLOW_TO_START | {'hashlib', 'pathlib', 'typing'}
"""The launcher runs twice for each verb, so it has less time: a Python alone takes 11 ms."""
OF_A_RUN = {
    *('IPython', 'alembic', 'babel', 'bleach', 'bs4', 'dask', 'distributed', 'jupyter_client'),
    *('jupyter_server', 'matplotlib', 'nbclient', 'nbconvert', 'numpy', 'rclpy', 'zmq'),
}
"""Packages of HEAVY for kernels and conversions: a run without new submissions needs none."""
PROGRAM = """
import json, sys
before = set(sys.modules)
try:
    {do}
except SystemExit:
    pass
names = set(sys.modules) - before
print(json.dumps(sorted({{name for name in names if hasattr(sys.modules[name], '__file__')}})))
"""
ASKED = {
    'no verb': [],
    '--help': ['--help'],
    '--help of a verb': ['grade', '--help'],
    'a verb that there is not': ['nonsense'],
    'an option that there is not': ['grade', '--nonsense'],
    'an argument is missing': ['collect'],
    'a choice that there is not': ['scores', '--format', 'nonsense'],
    'no number': ['grade', '--workers', 'two'],
    'no date': ['due', '03_publisher', 'tomorrow'],
}


def imported(do, *options):
    """Return what a new Python imports to do something."""
    command = [sys.executable, '-P', *options, '-c', PROGRAM.format(do=do)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return {name.partition('.')[0] for name in json.loads(done.stdout.splitlines()[-1])}


@pytest.mark.parametrize('arguments', ASKED.values(), ids=ASKED)
def test_reading_arguments_imports_no_heavy_module(arguments):
    found = imported(f'from grader.__main__ import main; main({arguments!r})')
    assert 'grader' in found
    assert found & (HEAVY | SLOW_TO_START) == set()


@pytest.mark.parametrize(
    'do',
    {
        'the question whether all is set up': 'from launcher.venv_inputs import is_set_up; '
        f'is_set_up({str(ROOT)!r})',
        'the way to a verb': 'from launcher.main import main; main(["--ready", "grade"])',
    }.values(),
)
def test_the_launcher_imports_no_slow_module(do):
    instead = 'import os; os.execve = lambda *_: sys.exit(); '
    found = imported(f'sys.path.append({str(ROOT)!r}); {instead}{do}', '-IS')
    assert 'launcher' in found
    assert found & OF_THE_LAUNCHER == set()


def test_a_run_without_new_submissions_imports_no_kernels_and_rebuilds_no_lesson(tmp_path, capsys):
    course = released_course(tmp_path)
    submit(course, 'ada', b'')  # nothing that could be run
    assert main(['grade'], course=course) == 0
    capsys.readouterr()
    do = (
        'from grader.__main__ import main; from grader.course import Course; '
        f'from pathlib import Path; main(["grade"], course=Course.at(Path({str(tmp_path)!r})))'
    )
    again = imported(do)
    assert {'nbgrader', 'sqlalchemy'} <= again
    assert again & OF_A_RUN == set()
    (course.gradebook / FOLDER / f'{TOY}.json').unlink()
    assert 'nbconvert' in imported(do)  # it is made anew, and then kept


def test_each_verb_has_a_function_that_can_be_imported():
    (choices,) = (action.choices for action in make_parser()._actions if action.choices)
    assert all(callable(parser.get_default('run')) for parser in choices.values())


def test_the_help_of_a_verb_says_what_it_does(capsys):
    with pytest.raises(SystemExit):
        make_parser().parse_args(['due', '--help'])
    assert '\n\nList due dates, or set one.\n\n' in capsys.readouterr().out


def test_the_platforms_on_the_command_line_are_those_that_have_a_table():
    assert list(PLATFORMS) == sorted(TABLES)
