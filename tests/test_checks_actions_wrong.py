"""A typical mistake in how an action server moves or what it publishes fails only that check."""

import contextlib
import time

import pytest
from arm_checks import failures
from my_robot_basics.checks import CheckFailed, action, moves
from nodes.running import imported

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC


# --- how a goal ends -----------------------------------------------------------------------------


class ForgetsSucceed(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        if handle.is_cancel_requested:
            handle.canceled()
        return MoveArm.Result(position=self.position)


class AbortsAtTheEnd(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        if handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return MoveArm.Result(position=self.position)


class EmptyResult(MoveArmServer):
    def finish(self, handle):
        super().finish(handle)
        return MoveArm.Result()


class ResultOfTheStart(MoveArmServer):
    def finish(self, handle):
        was_cancelled = handle.is_cancel_requested
        result = super().finish(handle)
        return result if was_cancelled else MoveArm.Result(position=self.start)


class TooFast(MoveArmServer):
    def begin(self, handle):
        super().begin(handle)
        self.seconds /= 1.2


class TooSlow(MoveArmServer):
    def begin(self, handle):
        super().begin(handle)
        self.seconds *= 1.2


class EndsLate(MoveArmServer):
    """Moves as it should, and reports from its goal for a fifth of its time before it ends."""

    async def execute(self, handle):
        self.begin(handle)
        while self.passed_sec() < 1.2 * self.seconds and not handle.is_cancel_requested:
            await self.sleep(STEP_SEC)
            self.step(handle)
        return self.finish(handle)

    def passed_sec(self):
        return (self.get_clock().now() - self.began).nanoseconds / 1e9


class SpeedOfBoth(MoveArmServer):
    def begin(self, handle):
        super().begin(handle)
        self.seconds *= sum(each**2 for each in self.way) ** 0.5 / max(1e-9, *map(abs, self.way))


class BeginsAtZero(MoveArmServer):
    """Each move begins at (0, 0), wherever the arm is."""

    def begin(self, handle):
        self.position = [0.0, 0.0]
        super().begin(handle)


# --- feedback ------------------------------------------------------------------------------------


class NoFeedback(MoveArmServer):
    def report(self, handle):
        pass


class SeldomFeedback(MoveArmServer):
    steps = 0

    def report(self, handle):
        self.steps += 1
        if self.steps % 4 == 0:
            super().report(handle)


class OneFeedback(MoveArmServer):
    def report(self, handle):
        if self.part == 1.0:
            super().report(handle)


class Reports(MoveArmServer):
    def report(self, handle):
        left = [abs(b - a) for a, b in zip(self.position, self.target, strict=True)]
        handle.publish_feedback(MoveArm.Feedback(**self.told(left)))


class TellsDegrees(Reports):
    def told(self, left):
        return {'position': [57.29578 * each for each in self.position], 'remaining': max(left)}


class TellsTheGoal(Reports):
    def told(self, left):
        return {'position': self.target, 'remaining': 0.0}


class TellsNoPosition(Reports):
    def told(self, left):
        return {'remaining': max(left)}


class TellsTheSum(Reports):
    def told(self, left):
        return {'position': self.position, 'remaining': sum(left)}


class TellsNoRemaining(Reports):
    def told(self, left):
        return {'position': self.position}


class OneJointLate(Reports):
    """Joint2 moves only in the second half."""

    def on_the_way(self):
        parts = self.part, max(0.0, 2.0 * self.part - 1.0)
        ways = zip(self.start, self.way, parts, strict=True)
        return [a + part * way for a, way, part in ways]

    def told(self, left):
        return {'position': self.position, 'remaining': max(left)}


class Accelerates(Reports):
    """The first half of the way takes most of the time."""

    def on_the_way(self):
        return [a + self.part**2 * way for a, way in zip(self.start, self.way, strict=True)]

    def told(self, left):
        return {'position': self.position, 'remaining': max(left)}


class Pauses(MoveArmServer):
    """Sends no feedback in the middle of a move."""

    def report(self, handle):
        if not 0.4 < self.part < 0.7:
            super().report(handle)


class DividesByTheWay(MoveArmServer):
    """The distance may be zero: then it raises, but it has no other mistake."""

    def step(self, handle):
        if self.seconds == 0.0:
            self.is_moving = False
            raise ZeroDivisionError
        super().step(handle)


class AbortsWhereItIs(MoveArmServer):
    def finish(self, handle):
        result = super().finish(handle) if self.seconds else MoveArm.Result(position=self.position)
        self.is_moving = False
        return result


# --- time -------------------------------------------------------------------------------------


class TakesTheWallClocksTime(MoveArmServer):
    """Waits on its own clock, and computes where the arm is from another one."""

    def begin(self, handle):
        super().begin(handle)
        self.began = time.monotonic()

    def step(self, handle):
        passed_sec = time.monotonic() - self.began
        self.part = min(1.0, passed_sec / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)


WRONG = [
    (
        ForgetsSucceed,
        'reaches',
        r'saw it aborted: call goal_handle.succeed\(\) before the exec',
    ),
    (
        AbortsAtTheEnd,
        'reaches',
        r'it aborted: call goal_handle.succeed\(\), and not abort\(\)',
    ),
    (EmptyResult, 'reaches', r'saw \[\]: fill in the position: MoveArm.Result\(position=…\)'),
    (ResultOfTheStart, 'reaches', 'this is where the arm was: put in where it is in the end'),
    (DividesByTheWay, 'reaches', 'the arm is there already, and so is at the goal: the execute'),
    (AbortsWhereItIs, 'reaches', 'the arm is there already, and so is at the goal: call goal_'),
    (TooFast, 'reaches', 'expected .* s for 1.20 rad .*: in each step, move by speed'),
    (TooSlow, 'reaches', 'expected .* s for 1.20 rad .*: in each step, move by speed'),
    (EndsLate, 'reaches', 'moves at the right speed: let it rest nowhere, and end the goal once'),
    (SpeedOfBoth, 'reaches', 'the speed is that of the faster joint, not of both together'),
    (
        TakesTheWallClocksTime,
        'reaches',
        r'take the time that has passed from self.get_clock\(',
    ),
    (BeginsAtZero, 'reaches cancels', 'start from where the arm is, at each goal'),
    (NoFeedback, 'feedback', r'saw none: call goal_handle.publish_feedback\(…\) in each step'),
    (SeldomFeedback, 'feedback', 'at 10 Hz or more, saw .* messages in .* s: publish feedback'),
    (OneFeedback, 'feedback', 'at 10 Hz or more, saw 1 message in .* s: publish feedback in ea'),
    (TellsDegrees, 'feedback', 'these are degrees: all positions of MoveArm are in radians'),
    (TellsTheGoal, 'feedback', 'feedback holds the same position all the time'),
    (TellsNoPosition, 'feedback', r'saw \[\]: put one position for each joint into feedback.pos'),
    (
        TellsTheSum,
        'feedback',
        'it is the distance of the one joint that is farthest away, not the sum',
    ),
    (TellsNoRemaining, 'feedback', 'it is 0 all the time: fill in feedback.remaining'),
    (OneJointLate, 'feedback', 'move both joints by the same part of their ways, so that they ar'),
    (Accelerates, 'feedback', 'move at one speed from start to goal, and publish each position'),
    (Pauses, 'feedback', r'saw a pause of [0-9.]+ s: publish feedback in each step of the move'),
]


@pytest.mark.parametrize(('node_class', 'checks', 'message'), WRONG)
def test_a_mistake_fails_the_expected_checks_and_names_its_cause(run, node_class, checks, message):
    run(node_class)
    found = failures()
    assert ' '.join(found) == checks, found
    with pytest.raises(AssertionError, match=message):
        raise AssertionError(next(iter(found.values())))


class RejectsSlow(MoveArmServer):
    def is_possible(self, goal):
        return super().is_possible(goal) and goal.speed >= 0.01


@pytest.mark.parametrize('node_class', [RejectsSlow, MoveArmServer])
def test_each_speed_above_zero_has_to_be_accepted(run, node_class):
    run(node_class)
    wrong = pytest.raises(
        CheckFailed, match=r'a goal at 0\.005 rad/s to be accepted, saw it rejected: every speed'
    )
    with wrong if node_class is RejectsSlow else contextlib.nullcontext():
        moves.expect_accepts(action('/move_arm', MoveArm), (1.56, -2.08), (-1.56, 2.08))
