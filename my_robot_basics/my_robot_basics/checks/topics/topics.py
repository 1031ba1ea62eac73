"""A topic for a check: record what arrives, publish, wait for one message."""

from collections.abc import Callable, Hashable
from typing import Any

from rclpy.duration import Duration

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics import looks, sampling
from my_robot_basics.checks.topics.earlier_looks import Wanted
from my_robot_basics.checks.topics.topic_endpoints import DISCOVERY_SEC, TopicEndpoints
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.graph import earlier_waits
from my_robot_basics.graph.stop_reasons import what_raised
from my_robot_basics.graph.watcher import Watcher

ONCE_MORE_SEC = 2.0
"""How long to wait for a message after `wait_for` has called `after` a second time."""
EXTRA_SEC = 0.3
"""How long to wait for messages that must not come before or after the right one."""


def topic(name: str) -> 'Topic':
    """The topic of that absolute name: record it, publish on it, or wait for a message.

    `topic('/kinematics/joint_states').record(seconds=10.0).assert_rate(hz=5.0)`
    """
    return Topic(name)


class Topic(TopicEndpoints):
    """One topic; each call of a method uses a ROS node of its own."""

    def record(
        self, seconds: float = 10.0, step_sec: float = 0.1, hold_sec: float = sampling.HOLD_SEC
    ) -> Recording:
        """Record `seconds` of the robot's time, beginning at a message (which does not count).

        The check drives the robot's clock in steps of `step_sec`, or in finer ones if messages
        come more often than every second step. To detect messages that ignore this clock, it
        stands still for `hold_sec` of wall time. If this has no clear result (the node does not
        follow the clock, answers too slowly, …), 4 s of wall time are recorded instead, or up to
        7 s if there is no second message before. When an exercise is judged, an earlier recording
        that is sufficient is reused. Raises CheckFailed if there is no publisher or no message.
        """
        wanted = Wanted(self.name, seconds=seconds, step_sec=step_sec)
        return looks.record(self, wanted, hold_sec=hold_sec)

    def publish(self, *messages: Any, timeout_sec: float = 10.0) -> None:
        """Wait for a subscription, publish messages, and wait until they have arrived.

        The publisher is RELIABLE and TRANSIENT_LOCAL: every subscription is compatible with that.
        Raises CheckFailed if there is no subscription.
        """
        with Watcher(shared=True) as watcher:
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
        type_: type | None = None,
    ) -> Any:
        """Return the first message for which the predicate holds (without one, the first at all).

        `after` is called once the subscription exists, so that no answer to what it publishes is
        lost. Raises CheckFailed if there is no publisher, or no such message in time. If others
        came, it shows what was `expected`, the last of them in the words of `seen`, and the `hint`
        (called with it, if it is a function). It does the same if a message comes for which
        `never` holds, before or soon after the right one. With `once`, any second message fails,
        too, with advice for a node that publishes once for each message: so publish only one in
        `after`. Types other than `type_` fail; without it, any standard type is allowed.
        """
        with Watcher(shared=True) as watcher:
            recorder = self.listen(watcher, type_=type_)
            if after is not None:
                if once and not self._has_answered(watcher, recorder):
                    self._expect_none_early(watcher, recorder)
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
                    self._expect_answer(watcher, recorder, after)
                if not received:
                    self.fail_silent(watcher, seen=f'no message in {timeout_sec:g} s')
                last = [*received, *wrong()][-1]
                others = f'{len(received)} others in {timeout_sec:g} s'
                fail(
                    expected=expected or f'a message on {self.name} that answers',
                    seen=shorten(seen(last)) if seen else others,
                    hint=hint(last) if callable(hint) else hint,
                )
            earlier_waits.remember(watcher.context, *self._answered(recorder))
            if once and (times := len(recorder.messages())) > 1:
                fail(
                    expected='one message for each that your node receives',
                    seen=f'{times} messages',
                    hint='publish once in each call of the callback, and not in a timer',
                )
            return found()[0]

    def _answered(self, recorder: Recorder) -> tuple[Hashable, object]:
        """The key and value to remember that the present publishers of the topic have answered."""
        return ('answers', self.name), recorder.endpoint_gids()

    def _has_answered(self, watcher: Watcher, recorder: Recorder) -> bool:
        return earlier_waits.is_known(watcher.context, *self._answered(recorder))

    def _expect_none_early(self, watcher: Watcher, recorder: Recorder) -> None:
        """No message comes before the check has sent anything. Raises CheckFailed."""
        watcher.spin_for(EXTRA_SEC)
        expect(
            not recorder.received,
            expected='one message for each that your node receives',
            seen='messages before it has received any',
            hint='publish once in each call of the callback, and not in a timer',
        )

    def _expect_answer(
        self, watcher: Watcher, recorder: Recorder, after: Callable[[], None]
    ) -> None:
        """Call `after` again: a node that answers only now publishes the preceding message.

        If the node has answered others at once, it leaves some out. Raises CheckFailed for both.
        """
        if self._has_answered(watcher, recorder):
            expect(
                bool(what_raised(recorder.publishers())),
                expected=f'a message on {self.name} for each that your node receives',
                seen='others answered, and this one not',
                hint='publish in every call of the callback, whatever the message holds',
                cause='a message that is not answered, where others were',
            )
            return
        after()
        expect(
            not watcher.spin_until(lambda: bool(recorder.received), timeout_sec=ONCE_MORE_SEC),
            expected=f'a message on {self.name} for each that your node receives',
            seen='the first one only when a second was sent',
            hint='publish what you make of the message that your callback is given, at once, and '
            'not of the one before',
        )
