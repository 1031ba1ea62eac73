"""Whether stamps come from the node's clock or from the computer's: usually both show one time.

The check moves the node's clock ahead, and the node's stamps must follow.
"""

import time
from collections.abc import Callable, Collection, Sequence
from typing import Any, NoReturn

from builtin_interfaces.msg import Time as TimeMessage
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.clock_use import are_left_alone
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import fail
from my_robot_basics.graph import graphs
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.watcher import Watcher

AHEAD_SEC = 5.0
"""How far the node's clock is moved ahead: a right stamp is never late by half of this."""
PROOFS = 3
"""How many messages are enough to decide which clock the stamps come from."""
PROOF_SEC = 2.0
"""How long to wait for PROOFS messages at most; the node's clock moves on by as much meanwhile."""
PROOF_STEP_SEC = 0.05
EXACT_NS = 1000
"""A stamp that was converted to a float and back differs by less than this."""
SETTLE_SEC = 0.5
"""How long to wait for a node to process a clock tick that it cannot confirm (wall time)."""
ATTEMPTS = 3
"""How often to try if the clock could not be driven: a busy machine may be slow at first."""
EXPECTED = "stamps of the node's clock at publication"
COMPUTERS = "they are the time of the computer's clock"
HOW = 'set message.header.stamp = self.get_clock().now().to_msg() before each publish'
WHY = "it differs from the computer's clock when a simulation, or this check, drives it"


def expect_to_follow(topic_name: str, type_: type, publishers: Collection[str]) -> None:
    """Move the nodes' clock ahead. Raises CheckFailed if the stamps do not follow.

    It passes if the nodes' clock cannot be moved, or if they publish nothing meanwhile.
    """
    for _ in range(0 if are_left_alone() else ATTEMPTS):
        try:
            seen: list[float] | None = _while_ahead(topic_name, type_, publishers)
        except Inconclusive:
            seen = _while_ahead_inside(topic_name, type_, publishers)
            if seen is None:
                continue
        # a stamp is AHEAD_SEC ahead if it is from the node's clock, 0 s if from the computer's
        if seen and all(abs(ahead) < AHEAD_SEC / 2 for ahead in seen):
            fail_computer()
        return


def _while_ahead(topic_name: str, type_: type, publishers: Collection[str]) -> list[float]:
    """How many seconds stamps are ahead of the computer's clock while the nodes' clock is ahead.

    Stamps equal to a time that `/clock` has shown are left out: they are right.
    """
    with Watcher(listens=True) as watcher:
        proofs = _receive_stamps(watcher, topic_name, type_)
        with SimulatedClock(watcher, needed=set(publishers)) as clock:
            shown_ns = [clock.now_ns]
            clock.tick(round(AHEAD_SEC * 1e9))
            since_ns = time.time_ns()
            for _ in range(round(PROOF_SEC / PROOF_STEP_SEC)):
                shown_ns.append(clock.now_ns)
                clock.tick(round(PROOF_STEP_SEC * 1e9))
                watcher.spin_for(PROOF_STEP_SEC)
                if len(proofs(since_ns)) >= PROOFS:
                    break
            return _ahead_sec(proofs(since_ns), [*shown_ns, clock.now_ns])


def _while_ahead_inside(
    topic_name: str, type_: type, publishers: Collection[str]
) -> list[float] | None:
    """The same for nodes without parameter services: their process sets use_sim_time itself.

    It sets it for all nodes on the graph: a publisher's stamps may come from another node's clock.
    Returns None if a publisher's node cannot be switched. A node cannot confirm that it has
    processed a tick, so it gets wall time for that.
    """
    with Watcher(listens=True) as watcher:
        if watcher.node.get_publishers_info_by_topic('/clock'):
            return None
        proofs = _receive_stamps(watcher, topic_name, type_)
        clock = watcher.node.create_publisher(Clock, '/clock', 1)
        names = {*publishers, *graphs.take_snapshot(watcher).nodes()}
        former = {name: student.set_use_sim_time(name, value=True) for name in names}
        try:
            if any(former[name] is None for name in publishers):
                return None
            shown_ns = _tick_ahead(watcher, clock, seconds=SETTLE_SEC)
            since_ns = time.time_ns()
            shown_ns += _tick_ahead(watcher, clock, seconds=PROOF_SEC)
            return _ahead_sec(proofs(since_ns), shown_ns)
        finally:
            # back to wall time: otherwise a timer would wait until the wall clock has caught up
            clock.publish(Clock(clock=Time(nanoseconds=time.time_ns()).to_msg()))
            watcher.spin_for(SETTLE_SEC)
            for name, value in former.items():
                if value is not None:
                    student.set_use_sim_time(name, value=value)


def _tick_ahead(watcher: Watcher, clock: Publisher, *, seconds: float) -> list[int]:
    """Publish a clock that is AHEAD_SEC ahead for `seconds`; return its times, in ns."""
    shown_ns = []
    for _ in range(round(seconds / PROOF_STEP_SEC)):
        shown_ns.append(time.time_ns() + round(AHEAD_SEC * 1e9))
        clock.publish(Clock(clock=Time(nanoseconds=shown_ns[-1]).to_msg()))
        watcher.spin_for(PROOF_STEP_SEC)
    return shown_ns


def _ahead_sec(stamps: Sequence[tuple[int, int]], shown_ns: Sequence[int]) -> list[float]:
    """How far stamps are ahead of the time they were sent, except those that `/clock` has shown.

    Those are exempt because a node's simulated clock stands still while its callback runs, and the
    computer's clock catches up.
    """
    return [
        (stamp_ns - sent_ns) / 1e9
        for stamp_ns, sent_ns in stamps
        if all(abs(stamp_ns - shown) > EXACT_NS for shown in shown_ns)
    ]


def _receive_stamps(
    watcher: Watcher, topic_name: str, type_: type
) -> Callable[[int], list[tuple[int, int]]]:
    """Subscribe; the function returned gives (stamp, send time) of messages sent since a time.

    All times are in ns; send times and that time are wall time.
    """
    received: list[tuple[int, int]] = []

    def receive(message: Any, info: dict) -> None:
        received.append((nanoseconds(message.header.stamp), info['source_timestamp']))

    asked = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    watcher.node.create_subscription(type_, topic_name, with_info(receive), asked)
    return lambda since_ns: [each for each in received if each[1] > since_ns]


def nanoseconds(stamp: TimeMessage) -> int:
    """A stamp as an exact integer: a float of seconds since the epoch resolves only 240 ns."""
    return stamp.sec * 10**9 + stamp.nanosec


def fail_computer() -> NoReturn:
    """Raise CheckFailed: the stamps are the time of the computer's clock."""
    fail(expected=EXPECTED, seen="the computer's clock", hint=f'{HOW}; {WHY}', cause=COMPUTERS)
