"""`./course test`: what it runs, what it runs again alone, and how it ends."""

import json
import os
import shutil
from pathlib import Path

import pytest
from course_machine import PYTHON, ROOT, Machine, with_programs


@pytest.fixture
def bare(tmp_path):
    """A machine with neither Python nor uv."""
    return Machine(tmp_path)


@pytest.fixture
def machine(bare):
    """A machine with a Python and a uv that only record their arguments."""
    return with_programs(bare)


def checks(machine, *arguments, ruff=0, mypy=0, pytest=0, again=None):
    """Run ./course test with checks that end with these codes; return its code and pytest runs."""
    again = pytest if again is None else again
    machine.course('scores')
    bin_folder = machine.root / '.venv/bin'
    for tool, ends in (('ruff', ruff), ('mypy', mypy)):
        (bin_folder / tool).write_text(f'#!/bin/sh\nexit {ends}\n')
        (bin_folder / tool).chmod(0o755)
    (bin_folder / 'python').write_text(
        f'#!/bin/sh\n{PYTHON}\n'
        f'case $* in *--last-failed*) exit {again} ;; *pytest*) exit {pytest} ;; esac\n'
    )
    run = machine.course('test', *arguments)
    calls = [call for call in machine.calls('python') if 'pytest' in call]
    return run.returncode, [call for call in calls if '--collect-only' not in call]


@pytest.mark.parametrize(
    ('ruff', 'mypy', 'pytest', 'code'),
    [
        (0, 0, 0, 0),
        (1, 0, 0, 1),
        (0, 2, 0, 2),
        (1, 2, 0, 2),
        (0, 0, 1, 1),
        (0, 0, 5, 5),
        (1, 2, 3, 3),
    ],
)
def test_course_test_exits_with_the_code_of_the_last_failure(machine, ruff, mypy, pytest, code):
    seen, calls = checks(machine, ruff=ruff, mypy=mypy, pytest=pytest)
    assert seen == code
    assert len(calls) == (2 if pytest == 1 else 1)


@pytest.mark.parametrize('again', [0, 1, 5])
def test_a_failed_test_is_run_again_alone_and_that_run_decides(machine, again):
    seen, calls = checks(machine, '-k', 'a name', pytest=1, again=again)
    assert seen == again
    assert '-k a name --last-failed -n 0' in calls[-1]


def test_course_test_passes_its_arguments_to_pytest(machine):
    _, [call] = checks(machine, '--slow', '-k', 'a name')
    assert call.endswith(' --slow -k a name')


@pytest.mark.parametrize('again', [0, 1, 5])
def test_a_lesson_that_differed_is_replayed_alone_and_as_a_whole(machine, again):
    for name in ('00_lesson', '01_lesson'):
        lesson = machine.root / f'solutions/{name}/{name}.ipynb'
        lesson.parent.mkdir(parents=True)
        lesson.touch()
    remembered = machine.root / '.pytest_cache/lessons/v/cache/lastfailed'
    remembered.parent.mkdir(parents=True)
    cells = [f'solutions/01_lesson/01_lesson.ipynb::Cell {n}' for n in (3, 5)]
    failed = dict.fromkeys(['tests/test_x.py::test_y', *cells], True)
    remembered.write_text(json.dumps(failed, indent=2))
    machine.course('scores')
    for tool in ('ruff', 'mypy'):
        (machine.root / '.venv/bin' / tool).write_text('#!/bin/sh\n')
        (machine.root / '.venv/bin' / tool).chmod(0o755)
    ends = f'*--nbval*-n\\ 0*) exit {again} ;; *--nbval*) exit 1 ;;'
    python = machine.root / '.venv/bin/python'
    python.write_text(f'#!/bin/sh\n{PYTHON}\ncase $* in {ends} esac\n')
    run = machine.course('test')
    assert run.returncode == again
    assert machine.calls('python')[-1].endswith(' -v -n 0 solutions/01_lesson/01_lesson.ipynb')


def test_course_test_replays_the_lessons_unless_files_are_named(machine):
    lesson = machine.root / 'solutions/00_lesson/00_lesson.ipynb'
    lesson.parent.mkdir(parents=True)
    lesson.touch()
    assert sorted('--nbval' in call for call in checks(machine)[1]) == [False, True]
    assert sorted('--nbval' in call for call in checks(machine, '--slow')[1]) == [False, True]
    assert ['--nbval' in call for call in checks(machine, 'tests/test_x.py')[1]] == [False]


@pytest.mark.parametrize('code', [0, 1, 5])
def test_ci_installs_missing_programs_and_exits_with_the_code_of_the_tests(bare, code):
    (bare.root / '.ci').mkdir()
    run_script = Path(shutil.copy(ROOT / '.ci/run', bare.root / '.ci/run'))
    (bare.root / 'course').write_text(f'#!/bin/sh\necho "course $*" >>"$CALLS"\nexit {code}\n')
    bare.program('apt-get', 'echo "apt-get $*" >>"$CALLS"')
    bare.program('chromium', '')
    (bare.programs / 'bash').symlink_to(shutil.which('bash'))
    run = bare.course(script=run_script)
    assert run.returncode == code
    packages = ['apt-get update', 'apt-get install'] if os.geteuid() == 0 else []
    assert [call.split(' -')[0] for call in bare.calls()] == [*packages, 'course test']
    if packages:
        assert bare.calls('apt-get install')[0].endswith(' bubblewrap')
