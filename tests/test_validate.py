"""*Validate*: its reports to students on their answers, before these are graded."""

import contextlib
import json
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import nbformat
import psutil
import pytest
from answered import ROOT, answered, read, students_environment
from nbformat.v4 import new_code_cell

NODE = """
class KinematicsPublisher(Node):
    def __init__(self):
        super().__init__('kinematics_publisher')
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.timer = self.create_timer(1 / 5, self.publish_pose)

    def publish_pose(self):
        message = JointState(name=['joint1', 'joint2'], position=[0.1, 0.2])
        message.header.frame_id = 'base_link'
        self.publisher.publish(message)
"""
PREDICTIONS = """
predict_delivery = dict.fromkeys(
    ['late_subscription', 'restarted_subscription', 'without_slash', 'same_namespace'], False
) | dict.fromkeys(
    ['two_publishers', 'absolute_in_namespace', 'remapped', 'capital_letter', 'other_type'], True
)
"""
INVENTED = """
endpoints = {'publishers': ['anna', 'bert'], 'subscriptions': ['carl', 'dora', 'emil', 'fritz']}
"""
LOSE_POINTS = {
    'a publisher without a stamp': ('03_publisher', {'five_hz': NODE}),
    'seven of nine predictions wrong': ('01_topics', {'predict_delivery': PREDICTIONS}),
    'invented node names': ('05_command_line', {'find_endpoints': INVENTED}),
}


def command(path, *options):
    clean = students_environment()
    run = [sys.executable, '-P', '-m', 'my_robot_basics.validate', *options, str(path)]
    return subprocess.run(run, env=clean, capture_output=True, text=True, check=False)


def validated(path):
    """Return Validate's report on a notebook, and its lines of progress."""
    run = command(path, '--json')
    *progress, last = map(json.loads, run.stdout.splitlines())
    report = last['report']
    assert run.returncode == (0 if report['passed'] else 1), run.stderr
    assert run.stderr == ''
    return report, [line['progress'] for line in progress]


def checks_of(report):
    return {check['name']: check for part in report['parts'] for check in part['checks']}


@pytest.mark.parametrize(('lesson', 'answers'), LOSE_POINTS.values(), ids=LOSE_POINTS)
def test_work_that_loses_points_is_not_promised_full_points(tmp_path, lesson, answers):
    report, _ = validated(answered(lesson, tmp_path, **answers))
    (name,) = answers
    part = next(part for part in report['parts'] if part['name'] == name)
    sure = [c for c in part['checks'] if c['outcome'] == 'passed' and not c['is_partly_hidden']]
    assert sum(check['points'] for check in sure) < sum(c['points'] for c in part['checks'])
    assert 'decided at grading' in report['summary'] or 'missing' in report['summary']
    assert 'Success' not in str(report)


def test_a_right_answer_passes_and_the_summary_counts_points_still_open(tmp_path):
    report, progress = validated(answered('02_joint_state', tmp_path))
    assert report['summary'] == ('All visible checks pass. 3 of 4 points are decided at grading.')
    names = checks_of(report)
    assert [check['outcome'] for check in names.values()] == ['passed'] * 3
    assert names['joint_names']['title'] == 'name holds joint1 and joint2, in this order'
    assert (names['joint_names']['is_partly_hidden'], names['joint_names']['points']) == (False, 1)
    assert names['radians']['is_partly_hidden']
    assert 'HIDDEN' not in names['radians']['source']
    assert progress[0] == 'to_joint_state: starting two kernels'
    assert progress[-1].startswith('to_joint_state: checking: The header holds')


def test_progress_is_reported_in_the_language_of_the_lesson(tmp_path):
    shutil.copy(ROOT / 'notebooks/zh_CN/02_joint_state/02_joint_state.ipynb', tmp_path)
    run = command(tmp_path / '02_joint_state.ipynb', '--json')
    (first, *progress, last) = map(json.loads, run.stdout.splitlines())
    assert first['words']['Validation Results'] == '检查结果'
    assert progress[0] == {'progress': 'to_joint_state：正在启动两个内核'}
    assert (
        progress[-1]['progress']
        == 'to_joint_state：正在检查：消息头里是给定的时间戳，以及坐标系 base_link'
    )
    assert 'report' in last


def test_a_written_answer_is_left_to_a_person(tmp_path):
    report, _ = validated(answered('05_command_line', tmp_path))
    text = checks_of(report)['explain_counts']
    assert (text['outcome'], text['points']) == ('by hand', 2)
    assert report['summary'].endswith('A person gives 2 points for what you have written.')


@pytest.mark.slow
def test_a_check_that_is_all_hidden_is_not_called_passed(tmp_path):
    report, _ = validated(answered('00_two_link_arm', tmp_path))
    assert checks_of(report)['reach-hidden']['outcome'] == 'at grading'


BROKEN = {
    'a syntax error': (
        {'to_joint_state': 'def to_joint_state(:\n    pass'},
        'stopped with SyntaxError: invalid syntax (line 1: def to_joint_state(:',
    ),
    'one that ends the kernel': ({'to_joint_state': 'import os; os._exit(0)'}, 'ended the kernel'),
    'one that calls exit': ({'to_joint_state': 'exit()'}, 'ended the kernel: it calls exit()'),
}


@pytest.mark.parametrize(('answers', 'said'), BROKEN.values(), ids=BROKEN)
def test_a_broken_cell_fails_its_checks_and_is_named_by_number(tmp_path, answers, said):
    report, _ = validated(answered('02_joint_state', tmp_path, **answers))
    (part,) = report['parts']
    assert {check['outcome'] for check in part['checks']} == {'failed'}
    told = [*part['troubles'], *(check['message'] for check in part['checks'])]
    cells = read('notebooks', '02_joint_state').cells
    number = next(i for i, cell in enumerate(cells, start=1) if cell.id == 'to_joint_state')
    said = f'your cell {number} (the answer to `to_joint_state`) {said}'
    assert any(said in line for line in told), told
    assert 'Traceback' not in str(report)


GIVEN_UP = {
    'a constructor': (
        '03_publisher',
        {'five_hz': NODE.replace('_publisher\')\n', '_publisher\')\n        while True: pass\n')},
        ' and was interrupted; at grading it has 10 s',
    ),
    'a cell': (
        '02_joint_state', {'to_joint_state': 'while True: pass'},
        ' and was interrupted; at grading it has 10 s',
    ),
    'a cell that cannot be interrupted': (
        '02_joint_state',
        {'to_joint_state': 'import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)'},
        ' and could not be interrupted; at grading it has 10 s',
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(('lesson', 'answers', 'said'), GIVEN_UP.values(), ids=GIVEN_UP)
def test_a_cell_that_does_not_return_is_given_up_and_not_called_wrong(
    tmp_path, lesson, answers, said
):
    report, progress = validated(answered(lesson, tmp_path, **answers))
    (part,) = report['parts']
    assert {check['outcome'] for check in part['checks']} == {'not checked'}
    (trouble,) = part['troubles']
    assert re.match(r'your cell \d+ \((the answer|it runs the answer) to `\w+`\) did not', trouble)
    assert ' did not return within ' in trouble
    assert any('waiting for cell ' in line for line in progress)
    assert trouble.endswith(said)
    assert not any('checking' in line for line in progress)
    assert report['summary'].endswith('could not be checked.')


@pytest.mark.slow
def test_an_answer_that_is_slow_and_right_is_not_called_wrong(tmp_path):
    """It takes longer than Validate waits, and less than the grader does."""
    right = next(c for c in read('solutions', '02_joint_state').cells if c.id == 'to_joint_state')
    slow = 'import time\nuntil = time.monotonic() + 5\nwhile time.monotonic() < until: pass\n'
    path = answered('02_joint_state', tmp_path, to_joint_state=slow + right.source)
    report, _ = validated(path)
    assert 'failed' not in {check['outcome'] for check in checks_of(report).values()}


@pytest.mark.slow
def test_a_function_that_does_not_return_runs_once_and_is_not_called_wrong(tmp_path):
    asked = tmp_path / 'asked'
    endless = f"""def to_joint_state(*args):
    open({str(asked)!r}, 'a').write('x')
    while True: pass
"""
    report, _ = validated(answered('02_joint_state', tmp_path, to_joint_state=endless))
    assert asked.read_text() == 'x'
    for check in checks_of(report).values():
        assert check['outcome'] == 'not checked'
        assert check['message'].startswith('expected an answer from `to_joint_state(')
        assert 'saw no answer within ' in check['message']
        assert ' s; at grading it has 10 s: look for a loop' in check['message']


@pytest.mark.slow
def test_only_demonstrations_that_define_needed_names_are_run(tmp_path):
    demo = next(c for c in read('notebooks', '02_joint_state').cells if 'as np' in c.source)
    assert 'demo' in demo.metadata.tags
    right = next(c for c in read('solutions', '02_joint_state').cells if c.id == 'to_joint_state')
    with_numpy = right.source.replace(
        '[radians(theta1_deg), radians(theta2_deg)]', 'list(np.radians([theta1_deg, theta2_deg]))'
    )
    path = answered('02_joint_state', tmp_path, to_joint_state=with_numpy)
    notebook = nbformat.read(path, as_version=4)
    first = next(c for c in notebook.cells if 'demo' in c.metadata.get('tags', ()) and c != demo)
    first.source = f'open({str(tmp_path / "ran")!r}, "w")'
    nbformat.write(notebook, path)
    report, _ = validated(path)
    assert report['summary'].startswith('All visible checks pass.')
    assert not (tmp_path / 'ran').exists()


@pytest.mark.slow
def test_validate_makes_no_workspace_even_if_an_answer_does(tmp_path):
    right = next(c for c in read('solutions', '03_publisher').cells if c.id == 'five_hz')
    make = f'make_workspace()\nopen({str(tmp_path / "ran")!r}, "w").close()\n'
    path = answered('03_publisher', tmp_path, five_hz=f'{make}{right.source}')
    clean = students_environment()
    subprocess.run(
        [sys.executable, '-P', '-m', 'my_robot_basics.validate', str(path)],
        env=clean | {'MY_ROBOT_BASICS_WORKSPACE': str(tmp_path / 'ros_ws')},
        capture_output=True,
        check=True,
    )
    assert (tmp_path / 'ran').exists()
    assert not (tmp_path / 'ros_ws').exists()


@pytest.mark.slow
def test_an_answer_may_use_a_module_beside_the_notebook_and_added_cells(tmp_path):
    (tmp_path / 'helper.py').write_text('from math import radians as to_rad\n')
    right = next(c for c in read('solutions', '02_joint_state').cells if c.id == 'to_joint_state')
    path = answered(
        '02_joint_state', tmp_path, to_joint_state=right.source.replace('radians(', 'to_rad(')
    )
    notebook = nbformat.read(path, as_version=4)
    notebook.cells += [new_code_cell('from helper import to_rad'), new_code_cell('1 / 0')]
    nbformat.write(notebook, path)
    assert validated(path)[0]['summary'].startswith('All visible checks pass.')


def damaged(path, damage):
    notebook = nbformat.read(path, as_version=4)
    cells = {cell.id: cell for cell in notebook.cells}
    damage(notebook, cells)
    nbformat.write(notebook, path)
    return path


def change_a_check(notebook, cells):
    cells['joint_names'].source = '"""name holds joint1 and joint2"""'


def take_a_check_away(notebook, cells):
    notebook.cells.remove(cells['joint_names'])


def split_the_answer(notebook, cells):
    first, rest = cells['to_joint_state'].source.split('    message = JointState()', 1)
    cells['to_joint_state'].source = first
    part = new_code_cell('    message = JointState()' + rest)
    part.metadata = nbformat.from_dict(cells['to_joint_state'].metadata)
    notebook.cells.insert(notebook.cells.index(cells['to_joint_state']) + 1, part)


def make_the_answer_text(notebook, cells):
    cells['to_joint_state'].cell_type = 'markdown'
    del cells['to_joint_state']['outputs'], cells['to_joint_state']['execution_count']


def take_the_answer_away(notebook, cells):
    notebook.cells.remove(cells['to_joint_state'])


DAMAGE = {
    change_a_check: (
        '(the check “name holds joint1 and joint2”) was changed: the original counts at grading',
        False,
    ),
    take_the_answer_away: ('the cell `to_joint_state` is missing: it comes back', False),
    take_a_check_away: ('the cell `joint_names` is missing: it comes back at grading', False),
    split_the_answer: ('(the answer to `to_joint_state`) came in parts: they are joined', True),
    make_the_answer_text: ('(the answer to `to_joint_state`) had another type', True),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ('damage', 'said'), DAMAGE.items(), ids=lambda each: getattr(each, '__name__', '')
)
def test_a_damaged_notebook_is_validated_as_far_as_possible(tmp_path, damage, said):
    note, is_whole = said
    report, _ = validated(damaged(answered('02_joint_state', tmp_path), damage))
    assert any(note in each for each in report['notes']), report['notes']
    assert report['passed'] == is_whole
    if damage is not take_the_answer_away:
        assert checks_of(report)['radians']['outcome'] == 'passed'
    if not is_whole:
        assert checks_of(report)['joint_names']['outcome'] == 'not checked'


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM], ids=str)
def test_a_signal_ends_validate_and_all_processes_that_it_started(tmp_path, number):
    path = answered('02_joint_state', tmp_path, to_joint_state='import time; time.sleep(600)')
    clean = students_environment()
    run = [sys.executable, '-P', '-m', 'my_robot_basics.validate', '--json', str(path)]
    with subprocess.Popen(run, env=clean, stdout=subprocess.PIPE, text=True) as process:
        while 'running your cells' not in process.stdout.readline():
            assert process.poll() is None
        begun = psutil.Process(process.pid).children(recursive=True)
        folders = {Path(p.cwd()).parents[1] for p in begun if p.cwd() != '/'}
        assert len(begun) >= 3
        assert len(folders) == 1
        process.send_signal(number)
        assert process.wait() == 130
    assert not any(child.is_running() for child in begun)
    assert [folder for folder in folders if folder.exists()] == []


DAEMON = """
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        open({file!r}, 'w').write(str(os.getpid()))
        time.sleep(600)
    os._exit(0)
while not os.path.exists({file!r}) or not open({file!r}).read():
    time.sleep(0.01)
"""


@pytest.mark.slow
def test_a_daemon_forked_by_an_answer_ends_with_validate(tmp_path):
    daemon = DAEMON.format(file=str(tmp_path / 'pid'))
    validated(answered('02_joint_state', tmp_path, to_joint_state=daemon))
    with contextlib.suppress(psutil.NoSuchProcess):
        psutil.Process(int((tmp_path / 'pid').read_text())).wait(60)


NO_LESSON = {
    'no such file': (None, 'cannot be read: No such file'),
    'not JSON': ('{', 'is not a notebook'),
    'another notebook': (
        '{"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}',
        'no exercise',
    ),
    'another notebook, with a byte order mark': (
        '\ufeff{"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}',
        'no exercise',
    ),
}


@pytest.mark.parametrize(('text', 'said'), NO_LESSON.values(), ids=NO_LESSON)
def test_a_file_that_is_not_a_lesson_is_refused_in_a_sentence(tmp_path, text, said):
    path = tmp_path / 'lesson.ipynb'
    if text is not None:
        path.write_text(text, encoding='utf-8')
    run = command(path)
    assert run.returncode == 2
    assert said in run.stderr
    assert 'Traceback' not in run.stderr


def test_course_validate_prints_marks_points_and_reasons(tmp_path):
    wrong = 'def to_joint_state(a, b, stamp): return JointState(name=["joint1", "joint2"])'
    path = answered('02_joint_state', tmp_path, to_joint_state=wrong)
    run = subprocess.run(
        [ROOT / 'course', 'validate', path.name],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 1
    assert '  ✓ name holds joint1 and joint2, in this order (1 point)\n' in run.stdout
    title = 'position holds both angles, in radians'
    assert f'  ✗ {title} (0 of 2 points; more checks at grading)' in run.stdout
    assert 'expected [0.5236, -1.5708] rad for (30.0, -90.0) degrees, saw []' in run.stdout
    assert run.stdout.endswith('2 of 3 visible checks fail: 3 points missing.\n')
