"""`reset` and `run_answer` in a real kernel: what is run as an answer, and what is refused."""

import pytest
from live_lesson import opened_lesson, stop_nodes_after


@pytest.fixture(scope='module')
def lesson():
    yield from opened_lesson()


@pytest.fixture(autouse=True)
def nothing_runs(request):
    yield from stop_nodes_after(request)


def test_reset_forgets_an_answer_and_run_answer_runs_only_the_students_own_node(lesson):
    lesson.run('run(Talker)')
    lesson.run('class Answer(Talker): pass')
    assert 'reset' in lesson.run("reset('Answer', 'never_defined')").stdout
    assert lesson.value("'Answer' in globals(), rclpy.ok()") == '(False, False)'
    error = lesson.run("run_answer('Answer')").error
    assert 'saw nothing of that name: run the answer cell' in ' '.join(error.split())
    assert len(error.splitlines()) <= 2
    where = 'write it in the answer cell: only the notebook is submitted'
    for definition, advice in {
        'Answer = 3': 'saw an object of type int: begin it with `class Answer(Node):`',
        'class Answer: pass': 'saw one that is not: begin it with `class Answer(Node):`',
        'from my_robot_basics.kinematics_publisher import KinematicsPublisher as Answer': where,
    }.items():
        lesson.run(definition)
        error = lesson.run("run_answer('Answer')").error
        assert error.startswith('NotRunnable: expected ')
        assert ' '.join(error.split()).endswith(advice)
        assert len(error.splitlines()) <= 2
    lesson.run("class Answer(Talker): pass\nanswer = run_answer('Answer', 'yes')")
    assert lesson.value('answer.text, alive(answer)') == "('yes', True)"
    lesson.run('reset()')
    assert lesson.run('rclpy.init(); rclpy.shutdown()').error is None


def test_run_answer_reports_a_node_that_the_answer_made_and_nothing_spins(lesson):
    lesson.run("reset('Answer')")
    lesson.run('class Answer(Talker): pass\nrclpy.init()\nmine = Answer()')
    error = lesson.run("run_answer('Answer')").error
    assert 'saw a node of it that nothing spins: leave out the' in ' '.join(error.split())
    assert len(error.splitlines()) <= 2
    lesson.run('mine.destroy_node()')
    assert lesson.run("answer = run_answer('Answer')").error is None
    lesson.run('reset()')


def test_a_node_of_a_former_answer_is_told_how_to_get_rid_of_it(lesson):
    lesson.run("reset('Answer')")
    lesson.run('class Answer(Talker): pass\nrclpy.init()\nmine = Answer()')
    lesson.run("run_answer('Answer')")
    lesson.run('class Answer(Talker): pass')  # without that line: but the notebook has its node
    error = ' '.join(lesson.run("run_answer('Answer')").error.split())
    assert error == (
        'NotRunnable: expected the class Answer alone, saw a node of it from before it was '
        'changed: run the cell with reset(…), then the answer cell, then this one'
    )
    lesson.run("reset('Answer')")
    lesson.run('class Answer(Talker): pass')
    assert lesson.run("answer = run_answer('Answer')").error is None


def test_the_traceback_of_an_answer_that_raises_shows_its_own_lines_and_none_of_the_course(lesson):
    lesson.run("reset('Answer')")
    lesson.run('class Answer(Node):\n    def __init__(self):\n        self.text = [][1]')
    error = lesson.run("run_answer('Answer')").error
    assert 'self.text = [][1]' in error
    assert 'exercise.py' not in error
    lesson.run('reset()')


CHECK = '"""Two and two are four"""\nfrom my_robot_basics.checks import expect\n'


@pytest.mark.parametrize('check', [CHECK, f"{CHECK}expect(False, expected=4, seen=5, hint='')"])
def test_a_check_of_an_answer_that_was_changed_since_its_node_was_made_says_so(lesson, check):
    answer, earlier = 'class Answer(Talker): pass', 'is from before Answer was changed: run the'
    lesson.run("reset('Answer')")
    lesson.run(answer)
    lesson.run("run_answer('Answer', 'yes')")
    assert earlier not in lesson.run(check).stdout
    lesson.run(answer)
    assert earlier in lesson.run(check).stdout
    assert earlier not in lesson.run('print("no check")').stdout
    lesson.run("run_answer('Answer', 'yes')")
    assert earlier not in lesson.run(check).stdout
    lesson.run(f'{answer}\nstop()')
    assert earlier not in lesson.run(check).stdout
    lesson.run('reset()')


def test_why_not_running_says_what_ended_the_node_of_an_answer(lesson):
    lesson.run('from my_robot_basics.graph.not_running import why_not_running')
    lesson.run("reset('Answer')\nclass Answer(Talker): pass\nrun_answer('Answer', 'yes')")
    unknown = 'the node is not running, so run the cell'
    assert unknown in lesson.value('why_not_running()')
    lesson.run("run(Talker, 'no')")
    replaced = 'because `run(Talker)` has started another node of the name /talker and ended'
    assert replaced in lesson.value('why_not_running()')
    lesson.run("run(Answer, 'again')")
    assert unknown in lesson.value('why_not_running()')
    lesson.run('stop(Answer)')
    stopped = 'no longer runs, because stop(…) was called after it was started, so run the cell'
    assert f'the node of Answer {stopped} with run_answer(…) again' in lesson.value(
        'why_not_running()'
    )
    lesson.run('reset()')
    assert unknown in lesson.value('why_not_running()')


IMPORTED = 'from my_robot_basics import kinematics_publisher as course\n'
TAKEN = {
    'derives': f'{IMPORTED}class Answer(course.KinematicsPublisher): pass',
    'derives by a class between': f"""{IMPORTED}
class Between(course.KinematicsPublisher): pass
class Answer(Between): pass""",
    'takes a method': f"""{IMPORTED}
class Answer(Node):
    publish_pose = course.KinematicsPublisher.publish_pose
    def __init__(self): super().__init__('answer')""",
    'makes one': f"""{IMPORTED}
class Answer(Node):
    def __init__(self):
        super().__init__('answer')
        self.inner = course.KinematicsPublisher()""",
}


@pytest.mark.parametrize('definition', TAKEN.values(), ids=TAKEN)
def test_an_answer_that_uses_a_node_of_the_course_is_refused(lesson, definition):
    lesson.run("reset('Answer')")
    assert lesson.run(definition).error is None
    error = ' '.join(lesson.run("run_answer('Answer')").error.split())
    assert error.startswith('NotRunnable: expected ')
    assert 'write your own in the answer cell' in error
    assert lesson.run('run(course.KinematicsPublisher); stop()').error is None


PROGRAMS = {
    'ros2 run': "'ros2', 'run', 'my_robot_basics', 'kinematics_publisher'",
    'python -m': "sys.executable, '-m', 'my_robot_basics.kinematics_publisher'",
}


@pytest.mark.parametrize('words', PROGRAMS.values(), ids=PROGRAMS)
def test_an_answer_that_starts_a_program_of_the_course_is_refused(lesson, words):
    start = f'subprocess.Popen([{words}], stderr=subprocess.DEVNULL)'
    lesson.run(f'import subprocess, sys\nbefore = {start}')
    lesson.run("reset('Answer')")
    lesson.run(f"""class Answer(Node):
    def __init__(self):
        super().__init__('answer')
        self.inner = {start}""")
    error = ' '.join(lesson.run("run_answer('Answer')").error.split())
    assert error.startswith("NotRunnable: expected a node of your own, saw the course's program")
    assert 'program kinematics_publisher started: write your own in the answer cell' in error
    inner = "next(n for n in __import__('gc').get_objects() if type(n) is Answer).inner"
    assert lesson.value(f'{inner}.poll() is None, before.poll() is None') == '(False, True)'
    lesson.run('before.kill(); before.wait()')


def test_an_answer_runs_again_beside_the_command_lines_of_a_later_exercise(lesson):
    lesson.run("reset('Answer')")
    lesson.run("""from my_robot_basics.live import run_commands
from my_robot_basics.live.packages import commands
arm = 'ros2 run my_robot_basics kinematics_publisher --ros-args -r __ns:=/later'""")
    assert 'arm: started' in lesson.run("run_commands('arm')").stdout
    lesson.run('class Answer(Talker): pass')
    assert lesson.run("answer = run_answer('Answer')").error is None
    assert lesson.value('alive(answer), commands._running[0].process.poll()') == '(True, None)'


def test_an_answer_may_call_the_courses_functions(lesson):
    lesson.run("reset('Answer')")
    lesson.run("""from my_robot_basics.two_link_kinematics import forward_kinematics
class Answer(Node):
    forward = staticmethod(forward_kinematics)
    def __init__(self):
        super().__init__('answer')
        self.point = self.forward(0.0, 0.0)""")
    assert lesson.run("answer = run_answer('Answer')").error is None
    assert lesson.value('answer.point[0] > 1.7') == 'True'
