"""A typical mistake in what an action server cancels or rejects fails only that check."""

import time

import pytest
from arm_checks import failures
from nodes.running import imported
from rclpy.action import ActionServer, GoalResponse
from rclpy.duration import Duration

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC


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


class EndsInTheCancelCallback(MoveArmServer):
    def cancel(self, handle):
        handle.canceled()
        return super().cancel(handle)


class FlagStays(MoveArmServer):
    """A flag of its own, which is never reset: the arm never moves again."""

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
    """Treats each goal as if the arm were already moving."""

    def judge(self, goal):
        answer = super().judge(goal)
        self.is_moving = True
        return answer


class TakesTwo(MoveArmServer):
    def judge(self, goal):
        return GoalResponse.ACCEPT if self.is_possible(goal) else GoalResponse.REJECT


WRONG = [
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
    (
        EndsInTheCancelCallback,
        'cancels',
        r'with event CANCELED.*, so call canceled\(\) in the execute callback, after',
    ),
    (FlagStays, 'cancels rejects', 'a request to cancel is for one goal: forget it when the'),
    (
        DegreesInTheLimits,
        'rejects',
        r'compare both angles with their limits in radians, `pi / 2` and `2 \* pi / 3`',
    ),
    (NoLimits, 'rejects', 'without goal_callback in ActionServer'),
    (LimitsTheWrongWayRound, 'rejects', 'every comparison with NaN is False, so check for what'),
    (LooksBeforeItCounts, 'rejects', 'its callback raised IndexError.*; fix that first'),
    (LocksItself, 'rejects', 'and let a goal that you reject change nothing in the node'),
    (TakesTwo, 'rejects', 'remember that the arm moves, and return GoalResponse.REJECT'),
]


@pytest.mark.parametrize(('node_class', 'checks', 'message'), WRONG)
def test_a_mistake_fails_the_expected_checks_and_names_its_cause(run, node_class, checks, message):
    run(node_class)
    found = failures()
    assert ' '.join(found) == checks, found
    with pytest.raises(AssertionError, match=message):
        raise AssertionError(next(iter(found.values())))
