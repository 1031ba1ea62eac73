"""A topic as a check sees it: record what arrives, publish, wait for one message."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from rclpy.duration import Duration

from my_robot_basics.checks import followers, sampling, wall_recording
from my_robot_basics.checks.clock_use import are_left_alone
from my_robot_basics.checks.inconclusive import Inconclusive
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.recording import Recording
from my_robot_basics.checks.topic_endpoints import DISCOVERY_SEC, TopicEndpoints
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import CheckFailed, Disturbed, expect, fail, shorten
from my_robot_basics.graph.raised import what_raised
from my_robot_basics.graph.watcher import Watcher

ONCE_MORE_SEC = 2.0
"""How long to wait for the answer to what is sent a second time."""
EXTRA_SEC = 0.3
"""How long to listen for what must not come beside the right message."""
LATE_SEC = 0.02
"""A machine that keeps a check waiting so long may make an honest node miss a period."""
LATE_LOOKS = 2
"""How many more recordings such a machine gets."""
VALIDATE_SEC = 28.0
"""How long a recording may take with all other looks at it: *Validate* gives a cell 30 s …"""
GRADING_SEC = 60.0
"""… and the grader 150 s, for two recordings at most."""
BEFORE_SEC = 0.5
"""How long to listen for a message before a node's clock is touched."""


def topic(name: str) -> 'Topic':
    """The topic of that (absolute) name, to be recorded, published on or waited for.

    `topic('/kinematics/joint_states').record(seconds=10.0).assert_rate(hz=5.0)`
    """
    return Topic(name)


class Topic(TopicEndpoints):
    """What a check may do with one topic; each call is a ROS node of its own while it lasts."""

    def record(
        self, seconds: float = 10.0, step_sec: float = 0.1, hold_sec: float = sampling.HOLD_SEC
    ) -> Recording:
        """Record `seconds` of the robot's time, beginning at a message (which does not count).

        The robot's clock is driven by the check in steps of `step_sec`, or in finer ones where
        messages come faster than every second step. Before, it stands still for `hold_sec` of wall
        time, unless the node has followed it before: one that ignores it publishes then. Where
        that proves nothing (the node does not follow the clock, answers too slowly, …) 4 s of wall
        time are recorded instead; up to 7 s where no second message comes sooner.
        Raises CheckFailed when there is no publisher or no message.
        """
        start = time.monotonic()
        with Watcher(shared=True) as watcher:
            recorder = self.listen(watcher)
            sent = watcher.spin_until_free(lambda: bool(recorder.received), free_sec=BEFORE_SEC)
            hold_sec = followers.hold_sec(recorder, hold_sec)
            found = sampling.simulated(
                watcher, recorder, seconds=seconds, step_sec=step_sec, hold_sec=hold_sec
            )
            if isinstance(found, Inconclusive):
                why, recording = found, wall_recording.wall(watcher, recorder, why=found)
            else:
                why, recording = None, found
                followers.remember(recorder)
            if not recording.messages and sent and not are_left_alone():
                self._expect_ends_by_itself(recorder)
            if not recording.messages:
                self.fail_silent(watcher, seen=f'no message in {recording.seconds:g} s')
        left_sec = _looks_sec() - (time.monotonic() - start)
        return self._to_look_again(recording, why, left_sec=left_sec, late_looks=LATE_LOOKS)

    def publish(self, *messages: Any, timeout_sec: float = 10.0) -> None:
        """Publish messages, once a subscription is there to receive them; wait until they arrived.

        The publisher is RELIABLE and TRANSIENT_LOCAL, which every subscription is content with.
        """
        with Watcher() as watcher:
            publisher = self.meet(
                watcher, type(messages[0]), depth=len(messages), timeout_sec=timeout_sec
            )
            for message in messages:
                publisher.publish(message)
            publisher.wait_for_all_acked(Duration(seconds=2))
            watcher.spin_for(DISCOVERY_SEC if self.sends_once(watcher) else 0.0)

    def wait_for(
        self,
        predicate: Callable[[Any], bool] | None = None,
        timeout_sec: float = 10.0,
        *,
        after: Callable[[], None] | None = None,
        expected: str = '',
        seen: Callable[[Any], object] | None = None,
        hint: str | Callable[[Any], str] = 'print what your node publishes and compare',
        never: Callable[[Any], object] | None = None,
        once: bool = False,
    ) -> Any:
        """The first message for which the predicate holds (the first of all without one).

        `after` is called once the subscription stands: what it publishes can't be missed.
        Raises CheckFailed when there is no publisher or no such message in time. Where there were
        others, it speaks of what was `expected`, of the last one, as `seen` puts it in words, and
        gives the `hint` (on that one, if it is a function); so it does where one comes for which
        `never` holds, alone or beside the right one: nothing that comes later changes that. With
        `once`, a second one for which the predicate holds fails, too, in words for a node that
        publishes once for each message: so publish one message in `after`.
        """
        with Watcher() as watcher:
            recorder = self.listen(watcher)
            if after is not None:
                after()

            def found() -> list:
                return [m for m in recorder.messages() if predicate is None or predicate(m)]

            def wrong() -> list:
                return [m for m in recorder.messages() if never is not None and never(m)]

            is_decided = watcher.spin_until(
                lambda: bool(found() or wrong()), timeout_sec=timeout_sec
            )
            if is_decided and (once or never is not None):
                watcher.spin_for(EXTRA_SEC)
            received = recorder.messages()
            if wrong() or not found():
                if not received and after is not None:
                    self._expect_none_late(watcher, recorder, after)
                if not received:
                    self.fail_silent(watcher, seen=f'no message in {timeout_sec:g} s')
                last = [*received, *wrong()][-1]
                others = f'{len(received)} others in {timeout_sec:g} s'
                fail(
                    expected=expected or f'a message on {self.name} that answers',
                    seen=shorten(seen(last)) if seen else others,
                    hint=hint(last) if callable(hint) else hint,
                )
            if once and (times := len(found())) > 1:
                fail(
                    expected='one message for each that your node receives',
                    seen=f'{times} messages',
                    hint='publish once in each call of the callback, and in no timer',
                )
            return found()[0]

    def _to_look_again(
        self, recording: Recording, why: Inconclusive | None, *, left_sec: float, late_looks: int
    ) -> Recording:
        def look_again(seconds: float) -> Recording:
            # it may have to wait as long for the message to begin at
            if left_sec < 2.0 * seconds:
                raise CheckFailed('there is no time for another look')
            start = time.monotonic()
            with Watcher(shared=True) as watcher:
                recorder = self.listen(watcher)
                again = wall_recording.wall(
                    watcher, recorder, why=why, seconds=seconds, timeout_sec=seconds
                )
            if again.late_sec < LATE_SEC or not late_looks:
                return again
            left = left_sec - (time.monotonic() - start)
            return self._to_look_again(again, why, left_sec=left, late_looks=late_looks - 1)

        return replace(recording, look_again=look_again)

    def _expect_ends_by_itself(self, recorder: Recorder) -> None:
        """Who sends nothing any more has raised something, or the change of its clock ended it."""
        expect(
            bool(what_raised(recorder.publishers())),
            expected=f'messages on {self.name}',
            seen="some, and none any more once the node was on the robot's clock (use_sim_time)",
            hint='let no loop end when sleep_for returns False: it does so when the clock changes',
            cause='the messages end',
            doubt=Disturbed,
        )

    def _expect_none_late(
        self, watcher: Watcher, recorder: Recorder, after: Callable[[], None]
    ) -> None:
        """Do once more what brings messages; who sends one only now sends the one before."""
        after()
        expect(
            not watcher.spin_until(lambda: bool(recorder.received), timeout_sec=ONCE_MORE_SEC),
            expected=f'a message on {self.name} for each that your node receives',
            seen='the first one only when a second was sent',
            hint='publish what you make of the message that your callback is given, at once, and '
            'not of the one before',
        )


def _looks_sec() -> float:
    return GRADING_SEC if student.is_in_test_room() else VALIDATE_SEC
