"""Whether stamps are the node's clock at publication, and what to say where they are not.

Where a node's own clock and the computer's show the same, as on the wall clock, a recording is no
proof: the node's clock is moved ahead, and its stamps must follow.
"""

import itertools
import statistics
import time
from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

from builtin_interfaces.msg import Time as TimeMessage
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.clock_use import are_left_alone
from my_robot_basics.checks.inconclusive import Inconclusive
from my_robot_basics.checks.rates import AT_ONCE_SEC, ONCE
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import CheckFailed, Starved, fail
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.watcher import Watcher

if TYPE_CHECKING:
    from my_robot_basics.checks.recording import Recording

MOST_OFF_SEC = {'simulated': 0.5, 'wall': 1.0}
"""How far a stamp may be from the time of publication, by clock."""
USUAL_OFF_SEC = 0.15
"""How far most of them may be: at 5 Hz, the stamp of the message before is further off."""
AHEAD_SEC = 5.0
"""How far the node's clock is moved: no honest stamp is so late."""
PROOFS = 3
"""Messages that show whose clock it is."""
PROOF_SEC = 2.0
"""How long to wait for them at most; a timer of the node's clock gets as much of its time."""
PROOF_STEP_SEC = 0.05
SETTLE_SEC = 0.5
"""How long a node may take to follow where nothing tells that it has."""
ATTEMPTS = 3
"""How often to try where the clock could not be driven: a busy machine may be slow just now."""
EXPECTED = "stamps of the node's clock at publication"
COMPUTERS = "they are the time of the computer's clock"
HOW = 'set message.header.stamp = self.get_clock().now().to_msg() before each publish'
WHY = "it differs from the computer's clock when a simulation, or this check, drives it"


def check_stamps(recording: 'Recording', messages: Sequence) -> None:
    """Each stamp is set, advances, and is near the time of publication. Raises CheckFailed.

    Where the recording was made by a look (one that can look again), it is the node's own clock.
    """
    stamps_ns = [_nanoseconds(message.header.stamp) for message in messages]
    if 0 in stamps_ns:
        _fail('a stamp of 0')
    if _come_in_pairs(recording, stamps_ns):
        fail(expected=EXPECTED, seen='two messages with one stamp at once', hint=ONCE)
    if any(later <= earlier for earlier, later in itertools.pairwise(stamps_ns)):
        _fail('a stamp that does not advance')
    offs = _offs(recording, stamps_ns)
    most, usual = MOST_OFF_SEC[recording.clock], statistics.median_low(offs)
    # a late message does not count, one period behind in all of them does
    late = [off for off in offs if abs(off) > most]
    wrong = [usual] if abs(usual) > USUAL_OFF_SEC else late
    sent = [sample.source_time_sec for sample in recording.messages]
    from_wall = [abs(ns / 1e9 - at) for ns, at in zip(stamps_ns, sent, strict=True)]
    is_wall = statistics.median(from_wall) <= USUAL_OFF_SEC
    # where all are wrong, one may also have been sent late
    is_told = is_wall if wrong == [usual] else max(from_wall) <= USUAL_OFF_SEC
    if wrong and recording.clock == 'simulated' and is_told:
        _fail_computer()
    doubt = Starved if wrong == late and recording.was_busy else CheckFailed
    for off in wrong:
        _fail(f'a stamp {abs(off):.1f} s {"ahead of" if off > 0.0 else "behind"} it', doubt)
    # on a busy machine, the driven clock may happen to show the computer's time as well
    if recording.look_again is not None and is_wall:
        expect_to_follow(recording.topic_name, type(messages[0]), recording.publishers)


def expect_to_follow(topic_name: str, type_: type, publishers: Collection[str]) -> None:
    """Move the nodes' clock ahead: stamps that stay behind fail.

    Nothing follows where the nodes do not let it be moved, or publish nothing meanwhile.
    """
    for _ in range(0 if are_left_alone() else ATTEMPTS):
        try:
            seen: list[float] | None = _while_ahead(topic_name, type_, publishers)
        except Inconclusive:
            seen = _while_ahead_inside(topic_name, type_, publishers)
            if seen is None:
                continue
        # each is off the computer's clock by as much as the node's is, or by nothing
        if seen and all(abs(ahead) < AHEAD_SEC / 2 for ahead in seen):
            _fail_computer()
        return


def _while_ahead(topic_name: str, type_: type, publishers: Collection[str]) -> list[float]:
    """How far stamps are ahead of the computer's clock, in seconds, while the nodes' clock is."""
    with Watcher(listens=True) as watcher:
        proofs = _receive_stamps(watcher, topic_name, type_)
        with SimulatedClock(watcher, needed=set(publishers)) as clock:
            clock.tick(round(AHEAD_SEC * 1e9))
            since_ns = time.time_ns()
            for _ in range(round(PROOF_SEC / PROOF_STEP_SEC)):
                clock.tick(round(PROOF_STEP_SEC * 1e9))
                watcher.spin_for(PROOF_STEP_SEC)
                if len(proofs(since_ns)) >= PROOFS:
                    break
            return proofs(since_ns)


def _while_ahead_inside(
    topic_name: str, type_: type, publishers: Collection[str]
) -> list[float] | None:
    """The same for nodes without parameter services, which their own process can switch.

    None where it does not. Nothing tells when a node has dealt with a tick: it gets wall time.
    """
    with Watcher(listens=True) as watcher:
        if watcher.node.get_publishers_info_by_topic('/clock'):
            return None
        proofs = _receive_stamps(watcher, topic_name, type_)
        clock = watcher.node.create_publisher(Clock, '/clock', 1)
        former = {name: student.set_use_sim_time(name, value=True) for name in publishers}
        try:
            if None in former.values():
                return None
            _tick_ahead(watcher, clock, seconds=SETTLE_SEC)
            since_ns = time.time_ns()
            _tick_ahead(watcher, clock, seconds=PROOF_SEC)
            return proofs(since_ns)
        finally:
            # on wall time, or a timer would wait until that has come
            clock.publish(Clock(clock=Time(nanoseconds=time.time_ns()).to_msg()))
            watcher.spin_for(SETTLE_SEC)
            for name, value in former.items():
                if value is not None:
                    student.set_use_sim_time(name, value=value)


def _tick_ahead(watcher: Watcher, clock: Publisher, *, seconds: float) -> None:
    for _ in range(round(seconds / PROOF_STEP_SEC)):
        ahead_ns = time.time_ns() + round(AHEAD_SEC * 1e9)
        clock.publish(Clock(clock=Time(nanoseconds=ahead_ns).to_msg()))
        watcher.spin_for(PROOF_STEP_SEC)


def _receive_stamps(
    watcher: Watcher, topic_name: str, type_: type
) -> Callable[[int], list[float]]:
    """Listen; what is returned tells how far each stamp since a wall time is ahead of that."""
    received: list[tuple[int, int]] = []

    def receive(message: Any, info: dict) -> None:
        received.append((_nanoseconds(message.header.stamp), info['source_timestamp']))

    asked = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    watcher.node.create_subscription(type_, topic_name, with_info(receive), asked)
    return lambda since_ns: [
        (stamp_ns - sent_ns) / 1e9 for stamp_ns, sent_ns in received if sent_ns > since_ns
    ]


def _come_in_pairs(recording: 'Recording', stamps_ns: Sequence[int]) -> bool:
    sent = [sample.time_sec for sample in recording.messages]
    apart = [
        later - earlier
        for (earlier, later), (stamp, after) in zip(
            itertools.pairwise(sent), itertools.pairwise(stamps_ns), strict=True
        )
        if stamp == after
    ]
    return bool(apart) and statistics.median(apart) < AT_ONCE_SEC  # a busy machine parts some


def _offs(recording: 'Recording', stamps_ns: Sequence[int]) -> list[float]:
    on_wall = recording.clock == 'wall'
    sent = [
        sample.source_time_sec if on_wall else recording.start_sec + sample.time_sec
        for sample in recording.messages
    ]
    return [stamp_ns / 1e9 - at for stamp_ns, at in zip(stamps_ns, sent, strict=True)]


def _nanoseconds(stamp: TimeMessage) -> int:
    """Exactly: as seconds since the epoch, stamps less than 240 ns apart would be one."""
    return stamp.sec * 10**9 + stamp.nanosec


def _fail_computer() -> NoReturn:
    fail(expected=EXPECTED, seen="the computer's clock", hint=f'{HOW}; {WHY}', cause=COMPUTERS)


def _fail(seen: str, doubt: type[CheckFailed] = CheckFailed) -> NoReturn:
    fail(expected=EXPECTED, seen=seen, hint=HOW, cause=f'they have {seen}', doubt=doubt)
