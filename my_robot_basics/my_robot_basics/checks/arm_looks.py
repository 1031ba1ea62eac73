"""Look at a server of `/move_arm` on the robot's clock, or on the wall clock if it ignores that.

A server that sleeps on wall time, or lets nothing else run meanwhile, gets short moves there. So
does one that waits on its node's clock and computes with another one, which is a mistake.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

from rcl_interfaces.srv import GetParameters

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.actions import Action, FollowedClock
from my_robot_basics.checks.arm_progress import bring, is_under_way, wait_for_probe
from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.goal_answers import Identity
from my_robot_basics.checks.inconclusive import Inconclusive
from my_robot_basics.checks.open_action import OpenAction
from my_robot_basics.checks.reported_speed import is_of_wall_time
from my_robot_basics.checks.robot_time import DrivenTime, WallTime
from my_robot_basics.checks.services import PARAMETERS_SEC
from my_robot_basics.checks.watched_arm import HASTE_SEC, STEP_NS, Pose, WatchedArm, goal
from my_robot_basics.feedback.hidden import is_advice

T = TypeVar('T')

PROBE_RAD, PROBE_SEC = 0.4, 0.6
"""A move on the wall clock. …"""
PROBE_ASK_SEC = 0.1
"""… So long after its start, the node is asked something else."""
CLOCK_PROBE_SEC, CLOCK_PROBE_MOST_SEC = 2.0, 6.0
"""A move on the robot's clock, and what it may take at most."""
BUSY_SEC = 6.0
"""How long a move takes at most on the robot's clock where the machine is too busy for more; …"""
WALL_SEC = 2.0
"""… And on the wall clock."""
HOLD_SEC, APART_SEC = 0.4, 0.2
"""How long the clock stands still before a server that ignores it is known, or computes with the
wall clock: then where it says that the arm is differs by more than the second."""
STEPS, STEPS_SEC = 4, 1.0
"""So many steps in which the arm goes farther meanwhile prove that it knows the wall clock alone,
and so long they are waited for, of time that was free."""
_clocks: dict[Identity, FollowedClock] = {}
"""The servers that were seen to follow a driven clock: the next grade cell asks the same one."""


def look(action: Action, body: Callable[[WatchedArm], T], *, start: Pose) -> T:
    """What `body` makes of the server, with the arm at `start`. Raises what it raises.

    On the robot's clock where the node follows it; else, or if that clock can't be driven, on the
    wall clock.
    """
    with action.opened() as server:
        on_wall = WatchedArm(server, WallTime(server.watcher), tuple(start), WALL_SEC)
        bring(on_wall, start)
        clock = _clock(action, on_wall)
        if clock == FollowedClock.DRIVEN:
            for longest_sec in math.inf, BUSY_SEC:
                if longest_sec <= action.known.longest_sec:
                    try:
                        return _driven(server, body, tuple(start), longest_sec)
                    except Inconclusive:
                        action.known.longest_sec = BUSY_SEC
                        bring(on_wall, start)
        on_wall.time = WallTime(server.watcher)
        on_wall.computes_on_wall = clock in (FollowedClock.BOTH, FollowedClock.WALL_ALONE)
        try:
            return body(on_wall)
        finally:
            on_wall.settle()


def _driven(
    server: OpenAction,
    body: Callable[[WatchedArm], T],
    start: tuple[float, ...],
    longest_sec: float = math.inf,
) -> T:
    with SimulatedClock(server.watcher, needed={server.node_name}) as clock:
        beats = server.ends.feedback.received
        time = DrivenTime(server.watcher, clock, step_ns=STEP_NS, beat=lambda: len(beats))
        arm = WatchedArm(server, time, start, longest_sec)
        try:
            return body(arm)
        finally:
            arm.settle()


def _clock(action: Action, arm: WatchedArm) -> FollowedClock:
    """Which clock the node follows; found out once for each server."""
    server, name, clocks = arm.server.identity(), arm.server.node_name, action.known.clocks
    if name not in clocks:
        clocks[name] = _clocks.get(server) or _seen_clock(arm)
    # that of the wall looks so on a busy machine, too: the grader asks again
    if clocks[name] != FollowedClock.WALL or is_advice():
        _clocks[server] = clocks[name]
    return clocks[name]


def _seen_clock(arm: WatchedArm) -> FollowedClock:
    is_free = _answers_while_it_moves(arm)
    arm.settle()
    clock = _waits_on(arm) if is_free else FollowedClock.WALL
    bring(arm, arm.start)
    return clock


def _probe(arm: WatchedArm, seconds: float) -> MoveArm.Goal:
    """A goal that takes so long, towards the middle."""
    first, *others = arm.start
    first += PROBE_RAD if first < 0.0 else -PROBE_RAD
    return goal([first, *others], speed=PROBE_RAD / seconds)


def _answers_while_it_moves(arm: WatchedArm) -> bool:
    """Whether the node answers other questions in the midst of a move.

    One that does not has no turn for `/clock`: asleep on it, it would never wake up.
    """
    watcher = arm.server.watcher
    asks = watcher.node.create_client(GetParameters, f'{arm.server.node_name}/get_parameters')
    watcher.spin_until(asks.service_is_ready, timeout_sec=PARAMETERS_SEC)
    probe = _probe(arm, PROBE_SEC)
    sent = arm.send(probe)
    watcher.spin_until(sent.is_over, timeout_sec=PROBE_ASK_SEC)
    asked = asks.call_async(GetParameters.Request(names=['use_sim_time']))
    watcher.spin_until_free(lambda: asked.done() or sent.is_over(), free_sec=HASTE_SEC)
    is_free = asked.done() and not sent.is_over()
    watcher.node.destroy_client(asks)
    wait_for_probe(arm, sent, probe.position, is_free=is_free)
    return is_free


def _waits_on(arm: WatchedArm) -> FollowedClock:
    """Whether a move stands still while the robot's clock does, and goes on with it."""

    def waits(driven: WatchedArm) -> FollowedClock:
        assert isinstance(driven.time, DrivenTime)
        probe = _probe(driven, CLOCK_PROBE_SEC)
        sent = driven.send(probe)
        driven.time.hold(HOLD_SEC)
        if sent.is_over() or sent.feedback_count() > 1:
            return FollowedClock.WALL_ALONE if _moves_on(driven, sent) else FollowedClock.WALL
        ends = driven.time.wait(sent.is_over, seconds=CLOCK_PROBE_MOST_SEC)
        if is_of_wall_time(driven, sent, probe.position, apart_sec=APART_SEC):
            return FollowedClock.BOTH
        if ends or _moves_with_clock(driven, sent, probe.position):
            return FollowedClock.DRIVEN
        return FollowedClock.WALL

    try:
        bring(arm, arm.start)
        return _driven(arm.server, waits, arm.start)
    except Inconclusive:
        return FollowedClock.WALL


def _moves_on(arm: WatchedArm, sent: SentGoal) -> bool:
    """Whether the arm moves on, by its feedback, while the robot's clock stands still.

    A node that gets the clock late jumps once; each of STEPS steps farther is none of its clock.
    """
    first = sent.feedback_count()
    arm.server.watcher.spin_until_free(
        lambda: sent.is_over() or sent.feedback_count() - first > STEPS, free_sec=STEPS_SEC
    )
    told = [message.position for _, message in sent.feedback()[first:]]
    steps = [abs(b[0] - a[0]) for a, b in pairwise(told) if a and b]
    return len(steps) >= STEPS and min(steps) > 0.0


def _moves_with_clock(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    """Whether a slow arm, which moved while the clock did, stands still once it does so again."""
    if not is_under_way(arm, sent, position):
        return False
    count = sent.feedback_count()
    assert isinstance(arm.time, DrivenTime)
    arm.time.hold(HOLD_SEC)
    return sent.feedback_count() - count <= 1
