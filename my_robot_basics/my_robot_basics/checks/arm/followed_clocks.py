"""Find out which clock a server of `/move_arm` follows, with short moves of its arm."""

import math
import time
from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

from rcl_interfaces.srv import GetParameters

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.actions.actions import FollowedClock
from my_robot_basics.checks.actions.open_action import OpenAction
from my_robot_basics.checks.arm.arm_progress import bring, is_under_way, wait_for_probe
from my_robot_basics.checks.arm.reported_speed import is_of_wall_time, reported_speed
from my_robot_basics.checks.arm.watched_arm import HASTE_SEC, STEP_NS, Pose, WatchedArm, goal
from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.clock.robot_time import DrivenTime
from my_robot_basics.checks.services.services import PARAMETERS_SEC

T = TypeVar('T')

PROBE_RAD, PROBE_SEC = 0.4, 0.6
"""A probe: a short move on the wall clock, by so many radians, in so many seconds."""
PROBE_ASK_SEC = 0.1
"""How long after the start of the probe the node is asked for a parameter, in seconds."""
CLOCK_PROBE_SEC, CLOCK_PROBE_MOST_SEC = 2.0, 6.0
"""How long a probe is to take on the robot's clock, and may take at most, in seconds of it."""
HELD_SEC = {'free_sec': 0.4, 'wall_sec': 1.0}
"""How long the clock is held to see whether a server ignores it: at most half of a probe, because
the feedback after that shows whether it computes with the wall clock."""
APART_SEC = 0.2
"""A server that reports positions over APART_SEC off its own clock then does so."""
STEPS, STEPS_SEC = 4, 1.0
"""If the arm moves on in each of STEPS steps while the robot's clock is held, the server uses the
wall clock alone. The check waits for these steps for STEPS_SEC of free time."""
FINE_NS, FINE_SEC, FINE_PART = 10_000_000, 0.3, 0.6
"""With STEP_NS, an arm that adds up much shorter steps is far too slow. If it has FINE_PART of its
speed with steps of FINE_NS, for FINE_SEC of the robot's time, it gets these."""


def run_on_driven_clock(
    server: OpenAction,
    body: Callable[[WatchedArm], T],
    start: tuple[float, ...],
    *,
    longest_sec: float = math.inf,
    step_ns: int = STEP_NS,
) -> T:
    """Return what `body` returns on the robot's clock. Raises what it raises, and Inconclusive.

    Moves take up to `longest_sec`, in steps of `step_ns`.
    """
    with SimulatedClock(server.watcher, needed={server.node_name}) as clock:
        beats = server.ends.feedback.received
        driven = DrivenTime(server.watcher, clock, step_ns=step_ns, beat=lambda: len(beats))
        arm = WatchedArm(server, driven, start, longest_sec)
        try:
            return body(arm)
        finally:
            arm.settle()


def measure_clock(arm: WatchedArm) -> FollowedClock:
    """Which clock the server follows, with the arm at `arm.start`, where it is then, too."""
    is_free = _answers_while_it_moves(arm)
    arm.settle()
    clock = _measure_clock_of_move(arm) if is_free else FollowedClock.WALL
    bring(arm, arm.start)
    return clock


def _probe(arm: WatchedArm, seconds: float) -> MoveArm.Goal:
    """A goal that moves joint1 towards 0, and takes so many seconds."""
    first, *others = arm.start
    first += PROBE_RAD if first < 0.0 else -PROBE_RAD
    return goal([first, *others], speed=PROBE_RAD / seconds)


def _answers_while_it_moves(arm: WatchedArm) -> bool:
    """Whether the node answers a parameter request during a move.

    If not, it does not receive `/clock` either: if it slept on that clock, it would never wake up.
    """
    watcher = arm.server.watcher
    asks = watcher.node.create_client(GetParameters, f'{arm.server.node_name}/get_parameters')
    watcher.spin_until(asks.service_is_ready, timeout_sec=PARAMETERS_SEC)
    probe = _probe(arm, PROBE_SEC)
    sent = arm.send(probe)
    watcher.spin_until(sent.is_over, timeout_sec=PROBE_ASK_SEC)
    asked = asks.call_async(GetParameters.Request(names=['use_sim_time']))
    watcher.spin_until_free(lambda: asked.done() or sent.is_over(), free_sec=HASTE_SEC)
    is_free, answered_ns = asked.done() and not sent.is_over(), time.time_ns()
    watcher.node.destroy_client(asks)
    wait_for_probe(arm, sent, probe.position, is_free=is_free)
    # the end of a move may be told after the answer, in much feedback that gets lost
    return is_free and not 0 < sent.over_ns() < answered_ns


def _measure_clock_of_move(arm: WatchedArm) -> FollowedClock:
    """Hold the robot's clock during a move, then drive it: which clock does the move follow?"""

    def waits(driven: WatchedArm) -> FollowedClock:
        assert isinstance(driven.time, DrivenTime)
        probe = _probe(driven, CLOCK_PROBE_SEC)
        sent = driven.send(probe)
        if driven.time.hold(lambda: sent.is_over() or sent.feedback_count() > 1, **HELD_SEC):
            return FollowedClock.WALL_ALONE if _moves_on(driven, sent) else FollowedClock.WALL
        ends = driven.time.wait(sent.is_over, seconds=CLOCK_PROBE_MOST_SEC)
        if is_of_wall_time(driven, sent, probe.position, apart_sec=APART_SEC):
            return FollowedClock.BOTH
        if ends:
            return FollowedClock.DRIVEN
        if not _moves_with_clock(driven, sent, probe.position):
            return FollowedClock.WALL
        told = reported_speed(driven, sent, probe.position).rad_per_sec
        is_slow = told < FINE_PART * probe.speed  # and has not only rested for a while
        is_fine = is_slow and _keeps_up_with_fine_steps(driven.time, sent)
        return FollowedClock.DRIVEN_FINELY if is_fine else FollowedClock.DRIVEN

    try:
        bring(arm, arm.start)
        return run_on_driven_clock(arm.server, waits, arm.start)
    except Inconclusive:
        return FollowedClock.WALL


def _moves_on(arm: WatchedArm, sent: SentGoal) -> bool:
    """Whether the arm moves on, by its feedback, while the robot's clock stands still.

    A node that receives `/clock` late may jump once; STEPS steps in a row show another clock.
    """
    first = sent.feedback_count()
    arm.server.watcher.spin_until_free(
        lambda: sent.is_over() or sent.feedback_count() - first > STEPS, free_sec=STEPS_SEC
    )
    told = [message.position for _, message in sent.feedback()[first:]]
    steps = [abs(b[0] - a[0]) for a, b in pairwise(told) if a and b]
    return len(steps) >= STEPS and min(steps) > 0.0


def _moves_with_clock(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    """Whether a slow arm, which moved while the clock was driven, stops when it is held again."""
    if not is_under_way(arm, sent, position):
        return False
    count = sent.feedback_count()
    assert isinstance(arm.time, DrivenTime)
    return not arm.time.hold(lambda: sent.feedback_count() - count > 1, **HELD_SEC)


def _keeps_up_with_fine_steps(time: DrivenTime, sent: SentGoal) -> bool:
    """Whether an arm that is far too slow with steps of STEP_NS is not with steps of FINE_NS."""
    first, time.step_ns = sent.feedback_count(), FINE_NS
    time.let_pass(sent.is_over, seconds=FINE_SEC)
    told = [(time.at_ns(at_ns), message) for at_ns, message in sent.feedback()[first:]]
    if len(told) < STEPS or not all(message.position for _, message in told):
        return False
    (began_ns, began), *_, (over_ns, last) = told
    gone_rad = abs(last.position[0] - began.position[0])
    return gone_rad >= FINE_PART * sent.goal.speed * (over_ns - began_ns) / 1e9
