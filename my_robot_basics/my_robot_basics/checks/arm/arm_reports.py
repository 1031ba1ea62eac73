"""Whether the feedback of `/move_arm` says where the arm is."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.arm.arm_lines import ON_LINE_RAD, off_line, parts_of_way, why_off_line
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_remaining import expect_remaining
from my_robot_basics.checks.arm.arm_report_times import longest_same_sec, rate_hz
from my_robot_basics.checks.arm.arm_results import IN_DEGREES
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.speed_hints import JUMPS
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad
from my_robot_basics.feedback.errors import fail

WANTED_HZ, LEAST_HZ = 10.0, 9.5
LARGEST_GAP_SEC = 0.35
"""A longer gap between two messages is a pause."""
FLOOD_HZ, NO_SLEEP_HZ = 500.0, 1000.0
"""Feedback at a higher rate comes from a loop that does not wait: on a move that ends too early;
and on the wall clock, where a loop that sleeps for a millisecond takes longer for each step."""
NO_WAIT = (
    'no step of the loop waits, and much of the feedback may be lost: write `await sleep(self, …)`'
)
EACH_STEP = 'publish feedback in each step of the move'
NONE = 'call goal_handle.publish_feedback(…) in each step of the move'
NONE_BLOCKED = (
    'call goal_handle.publish_feedback(…) in each step of the move; if you do, no step waits, and '
    'all feedback is lost: write `await sleep(self, …)`'
)
"""A loop without waits blocks the node's other callbacks, and so ignores the robot's clock."""
FEW = 'publish feedback in each step of the move, and take at least ten a second'
FEWEST = 5
PROGRESS_PART = 0.06
"""How far the arm may be ahead of a steady move or behind it, as a part of the way."""
MOST_TIMES = 3.0


def expect_feedback(
    action: Action, position: Pose, *, speed: float, start: Pose = (0.0, 0.0)
) -> None:
    """Send the arm from `start` to a position (rad), and check the feedback on this move.

    At 10 Hz or more, it has to hold where the arm is, on a straight line between the two, and how
    far it still has to go. Raises CheckFailed.
    """

    def reports(arm: WatchedArm) -> None:
        sent = arm.send(arm.goal(position, speed=speed))
        most_sec = MOST_TIMES * far_rad(arm.start, position) / sent.goal.speed
        wait_unless_it_crawls(arm, sent, position, seconds=most_sec)
        reported = MoveReport(arm, sent, tuple(position))
        reported.expect_enough()
        reported.expect_positions()
        reported.expect_line()
        reported.expect_steady()
        reported.expect_remaining()

    look(action, reports, start=start)


@dataclass
class MoveReport:
    """The feedback on one move."""

    arm: WatchedArm
    sent: SentGoal
    end: tuple[float, ...]

    def __post_init__(self) -> None:
        """Keep the messages that were received so far, and their times."""
        found = self.sent.feedback()
        self.times = np.array([self.arm.time.at_ns(sent_ns) / 1e9 for sent_ns, _ in found])
        self.messages = [message for _, message in found]

    def expect_enough(self) -> None:
        """Expect feedback at 10 Hz or more, without pauses. Raises CheckFailed."""
        count = len(self.messages)
        if not count:
            why = self.arm.why_no_feedback(self.sent)
            fail(
                expected='feedback during the move',
                seen='none',
                hint=why or (NONE if self.arm.time.is_driven else NONE_BLOCKED),
                cause='there is no feedback',
            )
        seconds = self.arm.seconds(self.sent)
        rate = rate_hz(self.times, is_driven=self.arm.time.is_driven) if count > 1 else 0.0
        never_sleeps = rate > NO_SLEEP_HZ and not self.arm.time.is_driven
        if never_sleeps or (rate > FLOOD_HZ and self.arm.was_early(self.sent, self.end)):
            fail(
                expected='feedback in steps that wait',
                seen=f'{count} messages without a wait between them',
                hint=NO_WAIT,
                cause='no step of the move waits',
            )
        if count < FEWEST or rate < LEAST_HZ:
            one, many = f'1 message in {seconds:.1f} s', f'{count} messages in {seconds:.1f} s'
            fail(
                expected=f'feedback at {WANTED_HZ:g} Hz or more',
                seen=one if count == 1 else many,
                hint=JUMPS if count < FEWEST and self.arm.was_early(self.sent, self.end) else FEW,
                cause='there is too little feedback',
                doubt=self.arm.doubt(self.sent, self.end),
            )
        over_sec = self.arm.time.at_ns(self.sent.over_ns()) / 1e9 if self.sent.is_over() else 0.0
        gap_sec = np.diff([*self.times, max(over_sec, self.times[-1])]).max()
        if gap_sec > LARGEST_GAP_SEC:
            fail(
                expected=f'feedback at {WANTED_HZ:g} Hz or more',
                seen=f'a pause of {gap_sec:.1f} s',
                hint=NO_WAIT if count > FLOOD_HZ * self.arm.seconds(self.sent) else EACH_STEP,
                cause='there are pauses in the feedback',
                doubt=self.arm.doubt(self.sent, self.end),
            )

    def expect_positions(self) -> None:
        """Expect the positions of both joints in each message, in radians. Raises CheckFailed."""
        for message in self.messages:
            seen = list(message.position)
            if len(seen) != len(self.end) or not all(map(math.isfinite, seen)):
                self._fail_position(
                    seen, 'put one position for each joint into feedback.position', 'two positions'
                )
        last, far_deg = list(self.messages[-1].position), [*map(math.degrees, self.end)]
        if np.allclose(last, far_deg, atol=0.1 * max(map(abs, far_deg))):
            self._fail_position(last, IN_DEGREES, 'angles in radians')

    def expect_line(self) -> None:
        """Expect all positions on the line from `arm.start` to the goal. Raises CheckFailed."""
        positions = self._positions()
        if np.ptp(positions, axis=0).max() < ON_LINE_RAD:
            hint = 'feedback holds the same position all the time: put in where the arm is now'
            self._fail_position(positions[-1], hint, 'positions on the way to the goal')
        off = off_line(positions, self.arm.start, self.end)
        if off.max() > ON_LINE_RAD:
            hint = why_off_line(positions, self.arm.start, self.end)
            self._fail_position(
                positions[int(off.argmax())], hint, 'positions on a straight line in joint space'
            )

    def expect_steady(self) -> None:
        """Expect the arm to move along the line at one speed, and feedback from its start on.

        Raises CheckFailed.
        """
        parts = parts_of_way(self._positions(), self.arm.start, self.end)
        on_the_way = parts < 1.0 - 1e-6
        times, parts = self.times[on_the_way], parts[on_the_way]
        if len(times) < FEWEST:
            self._fail_steady('tell where the arm is while it moves, not where it is to go')
        if np.diff(parts).min() < -PROGRESS_PART:
            self._fail_steady('the arm moves back and forth: see how the position is computed')
        steady = np.interp(times, [times[0], times[-1]], [parts[0], parts[-1]])
        late_part = self.arm.time.step_ns / 1e9 / np.ptp(times)  # on a busy machine, by a step
        if np.abs(parts - steady).max() > PROGRESS_PART + late_part:
            self._fail_steady('move at one speed from start to goal, and publish each position')
        if longest_same_sec(self.times, self._positions()) > LARGEST_GAP_SEC:
            self._fail_steady(
                'the same position is published for a while: compute it anew for each feedback'
            )
        silent_sec = parts[0] * np.ptp(times) / np.ptp(parts)
        if silent_sec > LARGEST_GAP_SEC:
            fail(
                expected='feedback from the start of the move on',
                seen=f'the first one {silent_sec:.1f} s after it',
                hint=EACH_STEP,
                cause='there is no feedback at the start of the move',
                doubt=self.arm.doubt(),
            )

    def expect_remaining(self) -> None:
        """Expect the right `remaining` in each message. Raises CheckFailed."""
        told = np.array([message.remaining for message in self.messages])
        expect_remaining(told, self._positions(), start=self.arm.start, end=self.end)

    def _positions(self) -> np.ndarray:
        return np.array([list(message.position) for message in self.messages])

    def _fail_position(self, seen: Sequence[float], hint: str, expected: str) -> None:
        fail(
            expected=f'{expected} in the feedback',
            seen=[round(float(each), 3) for each in seen],
            hint=hint,
            cause='feedback.position is wrong',
        )

    def _fail_steady(self, hint: str) -> None:
        fail(
            expected='positions that go steadily from start to goal',
            seen='others',
            hint=hint,
            cause='feedback.position is wrong',
            doubt=self.arm.doubt(),  # a move that is too fast has to be steady, too
        )
