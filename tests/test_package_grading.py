"""A package that was handed in is built and run in a sandbox, and judged by what it does."""

import pytest
from my_robot_basics.validate.lessons.cells import KEY
from my_robot_basics.validate.verdicts import budget
from package_maker import PACKAGE, make_package, package_lesson

from grader.judging.execute import execute

pytestmark = [pytest.mark.isolation, pytest.mark.starts]


def graded(folder, *, theirs='', **checks):
    """The outcome and the reason of each check; `theirs` is a cell of the student's."""
    notebook = package_lesson(**checks)
    [cell] = [cell for cell in notebook.cells if cell.id == 'try-it']
    cell.source, cell.metadata[KEY] = theirs, {'role': 'free'}
    done = execute(notebook, extra_files=[folder] if folder else [])
    assert [c.outputs for c in done.notebook.cells if c.id == 'try-it'] == [[]]
    return {each.grade_id: (each.outcome, each.reason) for each in done.verdicts}


def test_a_right_package_passes_and_no_cell_of_the_students_is_run(tmp_path):
    """Not even a cell that binds a name whose absence makes a check fail."""
    verdicts = graded(make_package(tmp_path), theirs='reset = package = 1 / 0')
    assert verdicts == {'builds': ('passed', ''), 'runs': ('passed', '')}


@pytest.mark.slow
def test_a_missing_package_and_a_wrong_one_are_reported(tmp_path):
    verdicts = graded(None)
    assert {outcome for outcome, _ in verdicts.values()} == {'failed'}
    assert 'there is no folder greeter/ beside this notebook' in verdicts['builds'][1]
    folder = make_package(tmp_path)
    (folder / 'resource' / PACKAGE).unlink()
    verdicts = graded(folder)
    assert 'setup.py installs resource/greeter, and there is no such file' in verdicts['builds'][1]
    assert verdicts['runs'][0] == 'failed'


@pytest.mark.slow
def test_no_cell_of_the_student_is_run_to_define_a_missing_name(tmp_path):
    """The cell would forge the answer of the build, and binds the name that colcon misses."""
    forger = (
        'x = 1\n'
        'from my_robot_basics.live.packages import packages\n'
        "told = {'found': True, 'status': 0, 'problem': '', 'executables': ['greet']}\n"
        'packages.answer_check = lambda *asked: told\n'
    )
    verdicts = graded(make_package(tmp_path, **{'setup.py': 'x\n'}), theirs=forger)
    assert {outcome for outcome, _ in verdicts.values()} == {'failed'}
    assert "setup.py, line 1: NameError: name 'x' is not defined" in verdicts['builds'][1]


HOSTILE = {
    'kills colcon': 'os.kill(os.getppid(), 9); time.sleep(600)',
    'kills all that it can': 'os.kill(-1, 9)',
    'fills the disk': "f = open('big', 'wb')\nwhile True: f.write(bytes(1 << 20)); f.flush()",
    'makes files without end': "for i in range(10**9): open(f'f{i}', 'w').close()",
    'forks without end': 'while True:\n    os.fork()',
    'leaves processes behind': (
        'for _ in range(20):\n    if os.fork() == 0: os.setsid(); time.sleep(600)\n1 / 0'
    ),
    'prints without end': "while True: print('x' * 100_000)",
    'writes into the package of the course': (
        "import my_robot_basics\nopen(my_robot_basics.__path__[0] + '/__init__.py', 'w').write('')"
    ),
    'writes into what was handed in': (
        "open(os.environ['MY_ROBOT_BASICS_PACKAGES'] + '/greeter/setup.py', 'w').write('')"
    ),
    'installs another package': (
        "os.makedirs('../../install/my_robot_basics/lib/my_robot_basics')\n1 / 0"
    ),
}
ORDINARY = ('kills colcon',)
"""The others are run by `./course test --slow`."""


@pytest.mark.parametrize(
    'code',
    [
        pytest.param(code, id=name, marks=() if name in ORDINARY else pytest.mark.slow)
        for name, code in HOSTILE.items()
    ],
)
def test_a_hostile_setup_py_earns_no_points_and_adds_no_files_to_the_submission(
    tmp_path, monkeypatch, code
):
    monkeypatch.setattr(budget, 'BUILD_TIMEOUT_SEC', 30.0)
    folder = make_package(tmp_path, **{'setup.py': f'import os, time\n{code}\n'})
    handed_in = contents_of(folder)
    verdicts = graded(folder)
    assert {outcome for outcome, _ in verdicts.values()} <= {'failed', 'ungraded'}, verdicts
    assert contents_of(folder) == handed_in
    assert {path.name for path in folder.iterdir()} == {
        *('package.xml', 'setup.py', 'setup.cfg', 'resource', 'greeter'),
    }


def contents_of(folder):
    """The bytes of each file in a folder, by its path."""
    return {path: path.read_bytes() for path in folder.rglob('*') if path.is_file()}


@pytest.mark.slow
def test_a_build_that_takes_too_long_is_left_to_a_person(tmp_path, monkeypatch):
    monkeypatch.setattr(budget, 'BUILD_TIMEOUT_SEC', 1.0)
    folder = make_package(tmp_path, **{'setup.py': 'import time\ntime.sleep(600)\n'})
    verdicts = graded(folder)
    assert {outcome for outcome, _ in verdicts.values()} == {'ungraded'}
    assert 'greeter was not built within 1 s' in verdicts['builds'][1]


@pytest.mark.slow
def test_a_successful_build_earns_no_points_for_an_executable_without_a_node(tmp_path):
    """The build succeeds, and its executable starts no node."""
    verdicts = graded(make_package(tmp_path, node='def main():\n    input()\n'))
    assert verdicts['builds'] == ('passed', '')
    outcome, reason = verdicts['runs']
    assert outcome == 'failed'
    assert 'expected the node /greeter of greet, saw it has ended: exit code 1' in reason
