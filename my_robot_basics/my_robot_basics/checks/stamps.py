"""Whether stamps are the node's clock at publication, and what to say where they are not.

Where a node's own clock and the computer's show the same, as on the wall clock, a recording is no
proof: the node's clock is moved ahead, and its stamps must follow.
"""

import itertools
import statistics
import time
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, NoReturn

from rclpy.qos import QoSProfile, ReliabilityPolicy

from my_robot_basics.checks.clock import Inconclusive, SimulatedClock
from my_robot_basics.checks.errors import fail
from my_robot_basics.checks.watcher import Watcher

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
ATTEMPTS = 3
"""How often to try where the clock could not be driven: a busy machine may be slow just now."""
EXPECTED = "stamps of the node's clock at publication"
AT_ONCE_SEC = 0.02
COMPUTERS = "they have the computer's clock"
ONCE = 'publish one message each time the timer fires'
HOW = 'set message.header.stamp = self.get_clock().now().to_msg() before each publish'
WHY = 'it is another one than that of the computer where a simulation, or this check, drives it'


def check_stamps(recording: 'Recording', messages: Sequence) -> None:
    """Each stamp is set, advances, and is near the time of publication. Raises CheckFailed.

    Where the recording was made by a look (one that can look again), it is the node's own clock.
    """
    stamps = [_seconds(message.header.stamp) for message in messages]
    if 0.0 in stamps:
        _fail('a stamp of 0')
    if _come_in_pairs(recording, stamps):
        fail(expected=EXPECTED, seen='two messages with one stamp at once', hint=ONCE)
    if any(later <= earlier for earlier, later in itertools.pairwise(stamps)):
        _fail('a stamp that does not advance')
    offs = _offs(recording, stamps)
    most, usual = MOST_OFF_SEC[recording.clock], statistics.median_low(offs)
    # a late message does not count, one period behind in all of them does
    late = [off for off in offs if abs(off) > most]
    wrong = [usual] if abs(usual) > USUAL_OFF_SEC else late
    from_wall = _from_wall(recording, stamps)
    if wrong and recording.clock == 'simulated' and max(from_wall) <= USUAL_OFF_SEC:
        _fail_computer()
    for off in wrong:
        _fail(f'a stamp {abs(off):.1f} s {"ahead of" if off > 0.0 else "behind"} it')
    # on a busy machine, the driven clock may happen to show the computer's time as well
    if recording.look_again is not None and statistics.median(from_wall) <= USUAL_OFF_SEC:
        expect_to_follow(recording.topic_name, type(messages[0]), recording.publishers)


def expect_to_follow(topic_name: str, type_: type, publishers: Collection[str]) -> None:
    """Move the nodes' clock ahead: stamps that stay behind fail.

    Nothing follows where the nodes do not let it be moved, or publish nothing meanwhile.
    """
    for _ in range(ATTEMPTS):
        try:
            seen = _while_ahead(topic_name, type_, publishers)
        except Inconclusive:
            continue
        # each is ahead of the computer's clock by as much as the node's is, or by nothing
        if seen and all(ahead < AHEAD_SEC / 2 for ahead in seen):
            _fail_computer()
        return


def _while_ahead(topic_name: str, type_: type, publishers: Collection[str]) -> list[float]:
    """How far stamps are ahead of the computer's clock, in seconds, while the nodes' clock is."""
    heard: list[tuple[float, int]] = []

    def hear(message: object, info: dict) -> None:
        heard.append((_seconds(message.header.stamp), info['source_timestamp']))

    with Watcher() as watcher:
        asked = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        watcher.node.create_subscription(type_, topic_name, hear, asked)
        with SimulatedClock(watcher, needed=set(publishers)) as clock:
            clock.tick(round(AHEAD_SEC * 1e9))
            since_ns = time.time_ns()

            def proofs() -> list[float]:
                return [sec - sent_ns / 1e9 for sec, sent_ns in heard if sent_ns > since_ns]

            for _ in range(round(PROOF_SEC / PROOF_STEP_SEC)):
                clock.tick(round(PROOF_STEP_SEC * 1e9))
                watcher.spin_for(PROOF_STEP_SEC)
                if len(proofs()) >= PROOFS:
                    break
            return proofs()


def _come_in_pairs(recording: 'Recording', stamps: Sequence[float]) -> bool:
    sent = [sample.time_sec for sample in recording.messages]
    apart = [
        later - earlier
        for (earlier, later), (stamp, after) in zip(
            itertools.pairwise(sent), itertools.pairwise(stamps), strict=True
        )
        if stamp == after
    ]
    return bool(apart) and max(apart) < AT_ONCE_SEC


def _offs(recording: 'Recording', stamps: Sequence[float]) -> list[float]:
    on_wall = recording.clock == 'wall'
    sent = [
        sample.source_time_sec if on_wall else recording.start_sec + sample.time_sec
        for sample in recording.messages
    ]
    return [stamp - at for stamp, at in zip(stamps, sent, strict=True)]


def _from_wall(recording: 'Recording', stamps: Sequence[float]) -> list[float]:
    pairs = zip(recording.messages, stamps, strict=True)
    return [abs(stamp - sample.source_time_sec) for sample, stamp in pairs]


def _seconds(stamp: object) -> float:
    return stamp.sec + stamp.nanosec * 1e-9


def _fail_computer() -> NoReturn:
    fail(expected=EXPECTED, seen="the computer's clock", hint=f'{HOW}; {WHY}', cause=COMPUTERS)


def _fail(seen: str) -> NoReturn:
    fail(expected=EXPECTED, seen=seen, hint=HOW, cause=f'they have {seen}')
