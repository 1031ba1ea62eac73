"""A typical mistake in an action server fails its check, and only that, with its cause."""

import time

import pytest
from my_robot_basics.checks import CheckFailed, action, moves
from nodes.running import imported
from rclpy.action import ActionServer, GoalResponse
from rclpy.duration import Duration

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC


def reaches(move_arm):
    moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.1)
    moves.expect_reaches(move_arm, (-0.9, 0.4), speed=0.2, start=(0.8, -0.3))


def feedback(move_arm):
    moves.expect_feedback(move_arm, (1.2, -0.6), speed=0.2)


def cancels(move_arm):
    moves.expect_cancels(move_arm, (1.2, -0.6), speed=0.2)
    moves.expect_late_cancel(move_arm, (0.9, 0.3))


def rejects(move_arm):
    moves.expect_rejects(
        move_arm,
        moves.goal((0.5, 0.5), speed=0.0),
        moves.goal((0.5,)),
        moves.goal((float('nan'), 0.5)),
        moves.goal((1.7, 0.0)),
    )
    moves.expect_one_at_a_time(move_arm, (0.9, 0.3), (-0.5, 1.0))


CHECKS = [reaches, feedback, cancels, rejects]
"""What the grade cells do, in their order."""


def failures():
    """Run all of them; what each says that fails."""
    move_arm, found = action('/move_arm', MoveArm), {}
    for check in CHECKS:
        try:
            check(move_arm)
        except CheckFailed as failure:
            found[check.__name__] = str(failure)
    return found


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
    """Joint2 moves in the second half alone."""

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
    """Tells nothing in the midst of a move."""

    def report(self, handle):
        if not 0.4 < self.part < 0.7:
            super().report(handle)


# --- cancel --------------------------------------------------------------------------------------


class NoCancelCallback(MoveArmServer):
    def make_server(self, **callbacks):
        del callbacks['cancel_callback']
        return ActionServer(self, MoveArm, '/move_arm', self.execute, **callbacks)


class NeverCanceled(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        if not handle.is_cancel_requested:
            handle.succeed()
        return MoveArm.Result(position=self.position)


class SucceedsAllTheSame(MoveArmServer):
    def finish(self, handle):
        self.is_moving = False
        handle.succeed()
        return MoveArm.Result(position=self.position)


class GoesOn(SucceedsAllTheSame):
    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0:
            await self.sleep(STEP_SEC)
            self.step(handle)
        return self.finish(handle)


class StopsLate(MoveArmServer):
    """Looks at the request every two seconds."""

    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            for _ in range(40):
                if self.part < 1.0:
                    await self.sleep(STEP_SEC)
                    self.step(handle)
        return self.finish(handle)


class SleepsOnTheOneThread(MoveArmServer):
    def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            self.wait()
            self.step(handle)
        return self.finish(handle)

    def wait(self):
        time.sleep(STEP_SEC)


class SleepsOnItsClock(SleepsOnTheOneThread):
    def wait(self):
        self.get_clock().sleep_for(Duration(seconds=STEP_SEC), context=self.context)


class GoesBackWhenCancelled(MoveArmServer):
    def finish(self, handle):
        result = super().finish(handle)
        if self.part < 1.0:
            self.position = self.start
        return result


class TellsTheGoalWhenCancelled(MoveArmServer):
    def finish(self, handle):
        super().finish(handle)
        return MoveArm.Result(position=self.target)


class FlagStays(MoveArmServer):
    """A flag of its own, which nobody takes back: the arm never moves again."""

    is_cancelled = False

    def cancel(self, handle):
        self.is_cancelled = True
        return super().cancel(handle)

    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not self.is_cancelled:
            await self.sleep(STEP_SEC)
            self.step(handle)
        return self.finish(handle)


# --- reject --------------------------------------------------------------------------------------


class DegreesInTheLimits(MoveArmServer):
    def is_possible(self, goal):
        limits = zip(goal.position, (90.0, 120.0), strict=False)
        is_two = len(goal.position) == 2
        return is_two and all(abs(q) <= limit for q, limit in limits) and goal.speed > 0.0


class NoLimits(MoveArmServer):
    def is_possible(self, goal):
        return True


class LimitsTheWrongWayRound(MoveArmServer):
    """NaN is above no limit."""

    def is_possible(self, goal):
        is_wrong = len(goal.position) != 2 or goal.speed <= 0.0
        return not is_wrong and not (abs(goal.position[0]) > 1.571 or abs(goal.position[1]) > 2.1)


class LooksBeforeItCounts(MoveArmServer):
    def is_possible(self, goal):
        first, second = goal.position[0], goal.position[1]
        return abs(first) <= 1.571 and abs(second) <= 2.095 and goal.speed > 0.0


class LocksItself(MoveArmServer):
    """It takes each goal for one that moves the arm."""

    def judge(self, goal):
        answer = super().judge(goal)
        self.is_moving = True
        return answer


class TakesTwo(MoveArmServer):
    def judge(self, goal):
        return GoalResponse.ACCEPT if self.is_possible(goal) else GoalResponse.REJECT


class DividesByTheWay(MoveArmServer):
    """Its way may be none: it raises then, and has forgotten nothing else."""

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
    (TellsTheSum, 'feedback', 'it is of the one joint that is farthest away, not the sum'),
    (TellsNoRemaining, 'feedback', 'it is 0 all the time: fill in feedback.remaining'),
    (OneJointLate, 'feedback', 'move both joints by the same part of their ways, so that they ar'),
    (Accelerates, 'feedback', 'move at one speed from start to goal, and publish each position'),
    (Pauses, 'feedback', r'saw a pause of [0-9.]+ s: publish feedback in each step of the move'),
    (NoCancelCallback, 'cancels', 'give ActionServer a cancel_callback that returns CancelRespon'),
    (NeverCanceled, 'cancels', r'call goal_handle.canceled\(\) before the execute callback retur'),
    (SucceedsAllTheSame, 'cancels', r'call goal_handle.canceled\(\), not succeed\(\)'),
    (
        GoesOn,
        'cancels',
        'the move goes on in spite of the request: look at goal_handle.is_can',
    ),
    (StopsLate, 'cancels', 'canceled within 0.2 s, saw it canceled after .*in each step'),
    (SleepsOnTheOneThread, 'cancels', 'at the end of the move: the execute callback keeps the no'),
    (SleepsOnItsClock, 'cancels', "at the end of the move: the execute callback keeps the node's"),
    (GoesBackWhenCancelled, 'cancels', 'a move begins where the arm was stopped: remember its po'),
    (TellsTheGoalWhenCancelled, 'cancels', 'put in where the arm is, not where it was to go'),
    (FlagStays, 'cancels rejects', 'a request to cancel is for one goal: forget it when the'),
    (DegreesInTheLimits, 'rejects', r'compare with radians\(90\) and radians\(120\)'),
    (NoLimits, 'rejects', 'reject a goal whose speed is not above 0'),
    (LimitsTheWrongWayRound, 'rejects', 'each comparison with NaN is False, so ask what is right'),
    (LooksBeforeItCounts, 'rejects', 'its callback raised IndexError.*so fix that first'),
    (LocksItself, 'rejects', 'and let a goal that you reject change nothing in the node'),
    (TakesTwo, 'rejects', 'remember that the arm moves, and return GoalResponse.REJECT'),
]


@pytest.mark.parametrize(('node_class', 'checks', 'message'), WRONG)
def test_a_mistake_fails_its_check_alone_with_the_cause(run, node_class, checks, message):
    run(node_class)
    found = failures()
    assert ' '.join(found) == checks, found
    with pytest.raises(AssertionError, match=message):
        raise AssertionError(next(iter(found.values())))


# --- who gets nowhere ----------------------------------------------------------------------------


class ReturnsTrue(MoveArmServer):
    def judge(self, goal):
        return self.is_possible(goal)


class FlagStuck(MoveArmServer):
    def finish(self, handle):
        result = super().finish(handle)
        self.is_moving = True
        return result


class ReturnsNothing(MoveArmServer):
    def finish(self, handle):
        super().finish(handle)


class RaisesInExecute(MoveArmServer):
    def step(self, handle):
        raise KeyError('joint3')


class NeverExecutes(MoveArmServer):
    def make_server(self, **callbacks):
        return super().make_server(handle_accepted_callback=lambda handle: None, **callbacks)


class NeverEnds(MoveArmServer):
    def step(self, handle):
        super().step(handle)
        self.part = 0.5


class WaitsForItsOwnTimer(MoveArmServer):
    def execute(self, handle):
        self.create_rate(20).sleep()


NOWHERE = [
    (
        ReturnsTrue,
        'end the goal callback with `return GoalResponse.ACCEPT` or `GoalResponse.RE',
    ),
    (FlagStuck, 'see that the node knows that the arm moves no longer'),
    (ReturnsNothing, r'end the execute callback with `return MoveArm.Result\(position=…\)`'),
    (RaisesInExecute, 'the execute callback raised an exception .*joint3.*so fix that first'),
    (NeverExecutes, r'a handle_accepted_callback calls goal_handle.execute\(\)'),
    (WaitsForItsOwnTimer, "the execute callback keeps the node's only thread: wait with"),
    (NeverEnds, 'end the loop of the execute callback when the arm is there'),
]


@pytest.mark.parametrize(('node_class', 'message'), NOWHERE)
def test_who_gets_nowhere_is_told_why(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        reaches(action('/move_arm', MoveArm))


def test_a_later_check_is_told_of_an_exception_before_it(run):
    run(RaisesInExecute)
    for check in CHECKS[:2]:
        with pytest.raises(CheckFailed, match=r'the execute callback raised .*joint3'):
            check(action('/move_arm', MoveArm))
