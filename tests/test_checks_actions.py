"""A node that serves an action passes, however it waits."""

import contextlib
import math
import random
import threading
import time

import pytest
from my_robot_basics.checks import CheckFailed, action, moves
from my_robot_basics.checks.actions.actions import FollowedClock
from my_robot_basics.checks.clock.clock import SimulatedClock
from nodes.running import STOPS, imported, running
from rclpy.action import GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor
from rclpy.task import Future

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC


def check_all():
    """Check everything that the exercise asks for, as its grade cells do."""
    move_arm, numbers = action('/move_arm', MoveArm), random.Random(7)
    moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.02)
    start, far = (moves.choose(numbers, farther=2, sign=sign) for sign in (1, -1))
    moves.expect_reaches(move_arm, far, speed=0.1, start=start)
    moves.expect_serves_on(move_arm, moves.choose(numbers))
    moves.expect_feedback(move_arm, (1.2, -0.6), speed=0.1)
    moves.expect_feedback(move_arm, moves.choose(numbers, farther=2), speed=0.1)
    moves.expect_cancels(move_arm, (1.2, -0.6), speed=0.2)
    moves.expect_late_cancel(move_arm, moves.choose(numbers))
    moves.expect_accepts(move_arm, *moves.choose_near_limits(numbers))
    moves.expect_one_at_a_time(move_arm, (0.9, 0.3), (-0.5, 1.0))
    moves.expect_rejects(move_arm, *moves.choose_wrong(numbers))


# --- right ones, on the robot's clock ------------------------------------------------------------


class TimerDriven(MoveArmServer):
    """One timer moves the arm; the execute callback waits for the end."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.goal_handle = None
        self.create_timer(STEP_SEC, self.tick)

    async def execute(self, handle):
        self.begin(handle)
        self.goal_handle, self.end = handle, Future()
        return await self.end

    def tick(self):
        if self.goal_handle is None:
            return
        if not self.goal_handle.is_cancel_requested:
            self.step(self.goal_handle)
        if self.goal_handle.is_cancel_requested or self.part == 1.0:
            handle, self.goal_handle = self.goal_handle, None
            self.end.set_result(self.finish(handle))


class HandlesAccepted(TimerDriven):
    """The goal is taken by handle_accepted_callback, and is executed only for its result."""

    def make_server(self, **callbacks):
        return super().make_server(handle_accepted_callback=self.take, **callbacks)

    def take(self, handle):
        self.waiting = handle
        handle.execute()


class FixedSteps(MoveArmServer):
    """Adds speed × step, without a look at the clock."""

    def step(self, handle):
        done = self.part * self.seconds + STEP_SEC
        self.part = min(1.0, done / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)


class ShortSteps(MoveArmServer):
    """Adds speed × 0.01 s in a loop that sleeps for 0.01 s: a fifth of the check's usual step."""

    async def sleep(self, seconds):
        await super().sleep(0.01)

    def step(self, handle):
        done = self.part * self.seconds + 0.01
        self.part = min(1.0, done / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)


class RestsFirst(MoveArmServer):
    """Rests for five seconds before a move, which is too late, but no matter of its steps."""

    async def execute(self, handle):
        if math.dist(handle.request.position, self.position) > 0.5 * handle.request.speed:
            await self.sleep(5.0)
        return await super().execute(handle)


class CoroutineCallbacks(MoveArmServer):
    async def judge(self, goal):
        return super().judge(goal)

    async def cancel(self, handle):
        return super().cancel(handle)


class Threads(MoveArmServer):
    """A blocking execute callback, and enough threads."""

    def __init__(self, **kwargs):
        self.lock = threading.Lock()
        super().__init__(**kwargs)
        executor = MultiThreadedExecutor(4, context=self.context)
        executor.add_node(self)
        STOPS.append(executor.shutdown)
        threading.Thread(target=executor.spin, daemon=True).start()

    def make_server(self, **callbacks):
        group = ReentrantCallbackGroup()
        return super().make_server(callback_group=group, **callbacks)

    def judge(self, goal):
        with self.lock:
            return super().judge(goal)

    def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            self.wait()
            self.step(handle)
        return self.finish(handle)

    def wait(self):
        self.get_clock().sleep_for(Duration(seconds=STEP_SEC), context=self.context)


class ThreadsWithARate(Threads):
    def execute(self, handle):
        self.rate = self.create_rate(1.0 / STEP_SEC)
        try:
            return super().execute(handle)
        finally:
            self.destroy_rate(self.rate)

    def wait(self):
        self.rate.sleep()


class ThreadsFixedSteps(Threads, FixedSteps):
    pass


class ThreadsOddSteps(Threads):
    """Adds up its sleeps, which are no multiple of a step of the check's clock."""

    ODD_SEC = 0.033

    def wait(self):
        self.get_clock().sleep_for(Duration(seconds=self.ODD_SEC), context=self.context)

    def step(self, handle):
        done = self.part * self.seconds + self.ODD_SEC
        self.part = min(1.0, done / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)


class FlagInExecute(MoveArmServer):
    """Sets its flag only when the arm starts to move."""

    def judge(self, goal):
        is_free = self.is_possible(goal) and not self.is_moving
        return GoalResponse.ACCEPT if is_free else GoalResponse.REJECT

    def begin(self, handle):
        self.is_moving = True
        super().begin(handle)


class AsksTheHandle(MoveArmServer):
    """Has no flag: it checks whether the last accepted goal is active."""

    last = None

    def make_server(self, **callbacks):
        return super().make_server(handle_accepted_callback=self.take, **callbacks)

    def take(self, handle):
        self.last = handle
        handle.execute()

    def judge(self, goal):
        is_busy = self.last is not None and self.last.is_active
        is_free = self.is_possible(goal) and not is_busy
        return GoalResponse.ACCEPT if is_free else GoalResponse.REJECT


ON_ITS_CLOCK = [
    MoveArmServer,
    TimerDriven,
    HandlesAccepted,
    FixedSteps,
    ShortSteps,
    CoroutineCallbacks,
    Threads,
    ThreadsWithARate,
    ThreadsFixedSteps,
    ThreadsOddSteps,
    FlagInExecute,
    AsksTheHandle,
]


@pytest.mark.parametrize('node_class', ON_ITS_CLOCK)
def test_each_correct_action_server_passes(run, node_class):
    run(node_class)
    check_all()


@pytest.mark.slow
def test_a_node_run_as_a_separate_program_passes():
    with running('move_arm_server'):
        check_all()


@pytest.fixture
def ticks(monkeypatch):
    """How far the robot's clock was moved by each step, in ns."""
    found, tick = [], SimulatedClock.tick
    monkeypatch.setattr(
        SimulatedClock, 'tick', lambda clock, ns: (found.append(ns), tick(clock, ns))
    )
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'least', 'most'), [(MoveArmServer, 200, 400), (FixedSteps, 1150, 1300)]
)
def test_a_move_of_a_robot_minute_is_checked_on_the_simulated_clock(
    run, ticks, node_class, least, most
):
    """The clock is driven in coarse steps, except for a server that adds up its own steps."""
    run(node_class)
    move_arm = action('/move_arm', MoveArm)
    moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.02)
    assert move_arm.known.clocks == {'/move_arm_server': FollowedClock.DRIVEN}
    assert sum(ticks) > 60e9
    assert least < len(ticks) < most


@pytest.mark.parametrize(
    ('node_class', 'clock'),
    [
        (ShortSteps, FollowedClock.DRIVEN_FINELY),
        (FixedSteps, FollowedClock.DRIVEN),
        (RestsFirst, FollowedClock.DRIVEN),
    ],
)
def test_a_server_that_adds_up_short_steps_gets_short_steps_of_the_clock(run, node_class, clock):
    """With the usual ones, it was told that its arm is five times too slow."""
    run(node_class)
    move_arm = action('/move_arm', MoveArm)
    late = pytest.raises(CheckFailed, match='let it rest nowhere')
    with late if node_class is RestsFirst else contextlib.nullcontext():
        moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.1)
    assert move_arm.known.clocks == {'/move_arm_server': clock}


@pytest.fixture
def loses_its_first_time(monkeypatch):
    """The second simulated clock publishes nothing on `/clock` before its first tick.

    It begins a while after the end of the first, so that nodes know no time that is right.
    """
    publish, clocks = SimulatedClock._publish, []

    def lose(clock):
        if clock not in clocks:
            clocks.append(clock)
            clock.now_ns += (len(clocks) == 2) * 10**10
        if clocks.index(clock) != 1 or clock._tick_ns:
            publish(clock)

    monkeypatch.setattr(SimulatedClock, '_publish', lose)
    return clocks


def test_a_node_that_receives_its_first_clock_message_late_still_passes(run, loses_its_first_time):
    """A position computed from a wall time of acceptance would be off by decades."""
    run(MoveArmServer)
    move_arm = action('/move_arm', MoveArm)
    moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.1)
    assert move_arm.known.clocks == {'/move_arm_server': FollowedClock.DRIVEN}
    assert len(loses_its_first_time) == 3


class ReportsSeldom(MoveArmServer):
    """A step of 0.2 s: its moves end up to 0.2 s late, and are not slower."""

    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            await self.sleep(0.2)
            self.step(handle)
        return self.finish(handle)


@pytest.mark.parametrize('seconds', [2.02, 3.0])
def test_an_arm_that_moves_in_coarse_steps_is_not_called_slow(run, seconds):
    run(ReportsSeldom)
    moves.expect_reaches(action('/move_arm', MoveArm), (1.2, -0.6), speed=1.2 / seconds)


# --- right ones, on the wall clock ---------------------------------------------------------------


class WallThreads(Threads):
    """Sleeps on wall time."""

    def wait(self):
        time.sleep(STEP_SEC)


class ThreadOfItsOwn(MoveArmServer):
    """A thread for each goal, which sleeps on wall time; one executor thread is enough then."""

    async def execute(self, handle):
        self.begin(handle)
        end = Future(executor=self.executor)
        threading.Thread(target=self.work, args=(handle, end), daemon=True).start()
        return await end

    def work(self, handle, end):
        while self.part < 1.0 and not handle.is_cancel_requested:
            time.sleep(STEP_SEC)
            self.step(handle)
        end.set_result(self.finish(handle))
        self.executor.wake()


class NoParameterServices(MoveArmServer):
    def __init__(self):
        super().__init__(start_parameter_services=False)


ON_THE_WALL_CLOCK = [WallThreads, ThreadOfItsOwn, NoParameterServices]


@pytest.mark.slow
@pytest.mark.parametrize('node_class', ON_THE_WALL_CLOCK)
def test_a_server_that_ignores_the_simulated_clock_passes_with_short_moves(run, node_class):
    run(node_class)
    check_all()


# --- checks of one's own -------------------------------------------------------------------------


def test_send_goal_returns_how_a_goal_ended(run):
    run(MoveArmServer)
    move_arm = action('/move_arm', MoveArm)
    outcome = move_arm.send_goal(moves.goal((0.5, 0.2), speed=5.0))
    assert outcome.status == 'succeeded'
    assert list(outcome.result.position) == pytest.approx([0.5, 0.2])
    assert outcome.feedback[-1].remaining == 0.0
    assert move_arm.send_goal(moves.goal((9.0, 0.2))).status == 'rejected'
    slow = move_arm.send_goal(moves.goal((-0.5, 0.2), speed=0.1), cancel_after_sec=0.2)
    assert slow.status == 'canceled'
    assert 0.0 < slow.result.position[0] < 0.5


def test_each_wrong_goal_has_exactly_one_fault():
    for seed in range(50):
        for wrong in moves.choose_wrong(random.Random(seed)):
            is_finite = all(map(math.isfinite, [*wrong.position, wrong.speed]))
            faults = [
                len(wrong.position) != 2,
                not is_finite,
                is_finite and wrong.speed <= 0.0,
                len(wrong.position) == 2
                and (
                    abs(wrong.position[0]) > math.pi / 2 or abs(wrong.position[1]) > math.pi / 1.5
                ),
            ]
            assert sum(faults) == 1


def test_wrong_goals_with_a_hint_of_their_own_come_after_angles_above_the_limits():
    limits = math.pi / 2, math.pi / 1.5
    for seed in range(50):
        goals = [list(wrong.position) for wrong in moves.choose_wrong(random.Random(seed))]
        above = [i for i, p in enumerate(goals) if len(p) == 2 and is_above(p, limits)]
        below = [
            i for i, p in enumerate(goals) if len(p) == 2 and is_above([-q for q in p], limits)
        ]
        turned = [i for i, p in enumerate(goals) if any(abs(q) > math.pi for q in p)]
        assert len(turned) == 1
        assert len(set(above) - set(turned)) == len(set(below) - set(turned)) == 2
        assert max(set(above) - set(turned)) < min(set(below) - set(turned)) < turned[0]


def is_above(position, limits):
    return any(limit < angle for angle, limit in zip(position, limits, strict=True))
