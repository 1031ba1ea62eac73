"""IK in the log: what counts as an answer, read from /rosout as at grading."""

import itertools
import time
from math import atan2, degrees, hypot

import pytest
from geometry_msgs.msg import Point
from my_robot_basics.checks import CheckFailed, rosout
from my_robot_basics.checks.nodes import sleepers
from my_robot_basics.two_link_kinematics import inverse_kinematics
from nodes.running import imported, running
from rclpy.logging import LoggingSeverity
from rclpy.node import Node

from my_robot_basics import live

IKSolver = imported('ik_solver').IKSolver

TARGET = Point(x=1.2, y=0.8)
SOLUTIONS = [*inverse_kinematics(1.2, 0.8).values()]
ANGLES = [angle for pair in SOLUTIONS for angle in pair]
TOO_FAR = Point(x=3.0, y=0.0)


def ask(log, target):
    log.ask('/target_point', target)


@pytest.mark.parametrize('node', ['ik_solver', 'ik_one_line'])
def test_angles_and_warnings_are_found_in_any_layout(node):
    with running(node), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        log.expect_angles(ANGLES)
        ask(log, TOO_FAR)
        log.expect_warning()
        assert log.numbers('INFO') == ()


class WarnsAndRaises(IKSolver):
    def solve(self, point):
        super().solve(point)
        if point.x > 2.0:
            raise ValueError('out of reach')


class LogsMuch(IKSolver):
    def report(self, solutions):
        self.get_logger().info('7.5 ' * 120_000)


def test_a_log_that_is_too_long_fails_instead_of_being_read():
    """Otherwise the grader would give up after 150 s, twice, and leave it to a person."""
    live.run(LogsMuch)
    words = 'the answer to one target in the log of /ik_solver_node, saw 480,000 characters: log'
    try:
        with rosout('ik_solver_node') as log:
            ask(log, TARGET)
            with pytest.raises(CheckFailed, match=words):
                log.expect_angles(ANGLES)
    finally:
        live.stop()


@pytest.mark.slow
def test_a_callback_that_warns_and_then_raises_fails():
    live.run(WarnsAndRaises)
    try:
        with rosout('ik_solver_node') as log:
            ask(log, TOO_FAR)
            with pytest.raises(CheckFailed, match=r'raised ValueError: out of reach .*fix that'):
                log.expect_warning()
        with rosout('ik_solver_node') as log:  # an earlier exception is not blamed on this answer
            ask(log, TARGET)
            log.expect_angles(ANGLES)
    finally:
        live.stop()


class HasNoLog(Node):
    def __init__(self):
        super().__init__('ik_solver_node', enable_rosout=False)


@pytest.mark.slow
def test_a_node_whose_log_is_turned_off_fails_with_advice():
    live.run(HasNoLog)
    reason = 'expected the log of /ik_solver_node on /rosout, saw none: leave enable_rosout=False'
    try:
        with pytest.raises(CheckFailed, match=reason), rosout('ik_solver_node'):
            pass
    finally:
        live.stop()


@pytest.mark.slow
def test_an_info_record_in_place_of_a_warning_is_reported():
    with running('ik_solver'), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match=r'saw no WARN record but .* needs the level WARN'):
            log.expect_warning(free_sec=1.0)


@pytest.mark.parametrize(
    ('node', 'reason'),
    [
        ('ik_prints', r'saw no INFO record: .*print\(…\) does not reach the log'),
        ('ik_coarse', 'two decimals or more'),
        ('ik_one_branch', 'log every solution, both angles of both branches: '),
        ('ik_always_warns', "saw 'careful': warn only when"),
        ('ik_warns_first', "saw 'careful': warn only when"),
    ],
)
def test_a_near_miss_fails_with_its_fault(node, reason):
    with running(node), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match=reason):
            log.expect_angles(ANGLES, free_sec=1.0)


@pytest.mark.slow
def test_a_warning_in_place_of_an_info_record_is_shown():
    with running('ik_solver'), rosout('ik_solver_node') as log:
        ask(log, TOO_FAR)
        words = (
            "saw no INFO record but 'WARN the target is 3 m.*: warn only when inverse_kinematics"
        )
        with pytest.raises(CheckFailed, match=words):
            log.expect_angles(ANGLES, free_sec=1.0)


@pytest.mark.slow
def test_an_answer_to_an_older_question_does_not_count():
    with running('ik_solver'):
        with rosout('ik_solver_node') as log:
            ask(log, TARGET)
            log.expect_angles(ANGLES)
            log.mark()
            with pytest.raises(CheckFailed):
                log.expect_angles(ANGLES, free_sec=0.5)
        with rosout('ik_solver_node') as later:
            # latched: the old records do arrive, and are left out
            assert not later.wait_for(lambda log: bool(log.records), timeout_sec=0.5)
            assert later._received


@pytest.mark.slow
def test_a_failure_names_the_target_point():
    with running('ik_one_branch'), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match=r'° for \(1\.200, 0\.800\) in the INFO log of /ik'):
            log.expect_angles(ANGLES, target=(1.2, 0.8), free_sec=1.0)


@pytest.mark.slow
def test_a_missing_warning_fails():
    with running('ik_solver'), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match='expected a warning in the log of /ik_solver_node'):
            log.expect_warning(free_sec=0.5)


def test_a_node_that_does_not_run_is_named(monkeypatch):
    monkeypatch.setattr('my_robot_basics.checks.nodes.node_log.NODE_SEC', 1.0)
    with pytest.raises(CheckFailed, match='expected a node /ik_solver_node, saw no node'):
        rosout('ik_solver_node').__enter__()


@pytest.mark.slow
def test_a_best_effort_subscription_misses_no_target():
    with running('ik_sensor_data'), rosout('ik_solver_node') as log:
        for _ in range(5):
            ask(log, TARGET)
            log.expect_angles(ANGLES)


@pytest.mark.slow
def test_a_second_warning_is_no_answer_to_the_next_target():
    with running('ik_warns_twice'), rosout('ik_solver_node') as log:
        ask(log, TOO_FAR)
        log.expect_warning()
        ask(log, TARGET)
        log.expect_angles(ANGLES)


@pytest.mark.slow
def test_a_repeated_answer_does_not_count_for_the_next_target():
    with running('ik_repeats'), rosout('ik_solver_node') as log:
        ask(log, TOO_FAR)
        log.expect_warning()
        ask(log, TARGET)
        log.expect_angles(ANGLES, may_lag=True)
        ask(log, Point(x=0.8, y=1.2))
        swapped = [90.0 - angle if abs(angle) != abs(ANGLES[1]) else angle for angle in ANGLES]
        assert log.expect_angles(swapped, may_lag=True) is False
        ask(log, TOO_FAR)
        log.expect_warning()


@pytest.mark.slow
def test_angles_logged_after_a_warning_fail_even_if_right_for_an_earlier_target():
    with running('ik_clings'), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        log.expect_angles(ANGLES)
        ask(log, TOO_FAR)
        with pytest.raises(CheckFailed, match=r'expected no angles from .* return from'):
            log.expect_warning()


@pytest.mark.slow
def test_a_warning_after_the_answer_is_not_excused_by_an_earlier_target():
    with running('ik_always_warns'), rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match="saw 'careful': warn only when"):
            log.expect_angles(ANGLES, may_lag=True, free_sec=1.0)


def test_a_running_node_of_another_name_is_named_as_the_cause(monkeypatch):
    monkeypatch.setattr('my_robot_basics.checks.nodes.node_log.NODE_SEC', 3.0)
    words = r"saw /ik_solver_node: .* super\(\)\.__init__\('ik'\)"
    with running('ik_solver'), pytest.raises(CheckFailed, match=words):
        rosout('ik').__enter__()


class SaysMore(IKSolver):
    """Logs where each target is, reachable or not, in several ways."""

    def solve(self, point):
        bearing_deg = degrees(atan2(point.y, point.x))
        self.get_logger().info(f'target at {hypot(point.x, point.y):.3f} m, {bearing_deg:.2f}°')
        self.get_logger().info(f'{bearing_deg:.2f}')
        self.get_logger().info(f'target: bearing={bearing_deg:.2f}°, z={point.z:.2f} m')
        super().solve(point)


def test_logged_positions_of_targets_do_not_count_as_angles(run):
    run(SaysMore)
    with rosout('ik_solver_node') as log:
        for x in 3.0, 0.05:
            ask(log, TARGET)
            log.expect_solutions(SOLUTIONS)
            ask(log, Point(x=x, y=0.02))
            bearing_deg = degrees(atan2(0.02, x))
            log.expect_warning(no_angles=[bearing_deg, bearing_deg + 180.0])


@pytest.mark.slow
@pytest.mark.parametrize('angles_deg', [(12.34, 56.78), (0.0, 0.0)])
def test_invented_angles_in_the_form_of_an_answer_fail(run, angles_deg):
    class Invents(IKSolver):
        def solve(self, point):
            super().solve(point)
            if point.x > 2.0:
                self.report({'up': angles_deg})

        def report(self, solutions):
            for theta1_deg, theta2_deg in solutions.values():
                self.get_logger().info(f'{theta1_deg:.2f}, {theta2_deg:.2f}')

    run(Invents)
    with rosout('ik_solver_node') as log:
        ask(log, TARGET)
        log.expect_solutions(SOLUTIONS)
        ask(log, TOO_FAR)
        with pytest.raises(CheckFailed, match=r'expected no angles from .* return from'):
            log.expect_warning()


def test_angles_paired_across_branches_fail(run):
    class MixesUp(IKSolver):
        def report(self, solutions):
            (up, elbow_up), (down, elbow_down) = solutions.values()
            super().report({'up': (up, elbow_down), 'down': (down, elbow_up)})

    run(MixesUp)
    with rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match='θ1 is paired with the θ2 of the other branch'):
            log.expect_solutions(SOLUTIONS)


@pytest.mark.parametrize('step_deg', [0.01, 0.25])
def test_a_table_of_all_angles_is_no_answer(run, step_deg):
    class Table(IKSolver):
        def report(self, solutions):
            count = round(360 / step_deg)
            self.get_logger().info(' '.join(f'{n * step_deg:.2f}' for n in range(count)))

    run(Table)
    with rosout('ik_solver_node') as log:
        ask(log, TARGET)
        with pytest.raises(CheckFailed, match=r'different numbers: log the solutions of each'):
            log.expect_solutions(SOLUTIONS)


def test_zeros_for_a_target_out_of_reach_are_a_failure():
    with running('ik_stretches'), rosout('ik_solver_node') as log:
        ask(log, TOO_FAR)
        with pytest.raises(CheckFailed, match=r"saw 'stretched: θ1=0.00°, θ2=0.00°'"):
            log.expect_warning(no_angles=ANGLES)


def test_angles_for_a_target_out_of_reach_are_a_failure():
    with running('ik_stretches'), rosout('ik_solver_node') as log:
        ask(log, Point(x=3.0, y=2.0))
        log.expect_warning(no_angles=ANGLES)
        ask(log, Point(x=3.0, y=3.0))
        with pytest.raises(CheckFailed, match=r'expected no angles from .* return from'):
            log.expect_warning(no_angles=[45.0])


class SkipsEqual(IKSolver):
    last = None

    def solve(self, point):
        if point != self.last:
            super().solve(point)
        self.last = point


@pytest.mark.slow
def test_a_repeated_target_needs_an_answer_of_its_own():
    live.run(SkipsEqual)
    try:
        with rosout('ik_solver_node') as log:
            ask(log, TARGET)
            log.expect_angles(ANGLES)
            ask(log, TARGET)
            with pytest.raises(CheckFailed, match='also one that is equal to the target before'):
                log.expect_angles(ANGLES, free_sec=1.0)
            ask(log, TOO_FAR)
            log.expect_warning()
            ask(log, TOO_FAR)
            with pytest.raises(CheckFailed, match='also one that is equal to the target before'):
                log.expect_warning(free_sec=1.0)
    finally:
        live.stop()


class LogsInOneLine(IKSolver):
    def solve(self, point):
        try:
            text, say = str(inverse_kinematics(point.x, point.y)), self.get_logger().info
        except ValueError as error:
            text, say = str(error), self.get_logger().warning
        say(text)


@pytest.mark.slow
def test_one_log_call_for_two_levels_fails_with_its_cause():
    live.run(LogsInOneLine)
    words = 'severity cannot be changed between calls.*, so log each level in a line of its own'
    try:
        with rosout('ik_solver_node') as log:
            ask(log, TARGET)
            log.expect_angles(ANGLES)
            ask(log, TOO_FAR)
            with pytest.raises(CheckFailed, match=words):
                log.expect_warning(free_sec=1.0)
    finally:
        live.stop()


class Sleeps(IKSolver):
    def solve(self, point):
        time.sleep(point.z)
        super().solve(point)


def test_a_callback_that_sleeps_is_not_waited_for_even_if_no_time_is_free(monkeypatch):
    monkeypatch.setattr(sleepers, 'free_turns', lambda free_sec: itertools.count())
    live.run(Sleeps)
    named = r'a callback sleeps in line \d+ \(time\.sleep\(point\.z\)\), so the answer comes too l'
    try:
        with rosout('ik_solver_node') as log:
            ask(log, Point(x=1.2, y=0.8, z=sleepers.PATIENT_SEC + 0.5 * sleepers.ASLEEP_SEC))
            log.expect_angles(ANGLES)
            ask(log, Point(x=1.2, y=0.8, z=60.0))
            with pytest.raises(CheckFailed, match=named):
                log.expect_angles(ANGLES)
    finally:
        live.stop()


class Quiet(IKSolver):
    def __init__(self):
        super().__init__()
        self.get_logger().set_level(LoggingSeverity.ERROR)


def test_a_logger_that_drops_a_level_is_named():
    live.run(Quiet)
    try:
        with rosout('ik_solver_node') as log:
            ask(log, TARGET)
            with pytest.raises(CheckFailed, match=r'drops INFO records.*LoggingSeverity\.INFO'):
                log.expect_angles(ANGLES, free_sec=0.5)
            ask(log, TOO_FAR)
            with pytest.raises(CheckFailed, match=r'drops WARN records.*LoggingSeverity\.WARN'):
                log.expect_warning(free_sec=0.5)
    finally:
        live.stop()
