"""A topic as a check sees it: record what arrives, publish, wait for one message."""

from collections.abc import Callable, Hashable
from typing import Any

from rclpy.duration import Duration

from my_robot_basics.checks import looks, sampling
from my_robot_basics.checks.earlier_looks import Wanted
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.recording import Recording
from my_robot_basics.checks.topic_endpoints import DISCOVERY_SEC, TopicEndpoints
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.graph import familiar
from my_robot_basics.graph.raised import what_raised
from my_robot_basics.graph.watcher import Watcher

ONCE_MORE_SEC = 2.0
"""How long to wait for the answer to what is sent a second time."""
EXTRA_SEC = 0.3
"""How long to listen for what must not come beside the right message."""


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
        messages come faster than every second step. Where they may ignore it, it stands still for
        `hold_sec` of wall time: they go on then. Where that proves nothing (the node does not
        follow the clock, answers too slowly, …) 4 s of wall time are recorded instead; up to 7 s
        where no second message comes sooner.
        Where an exercise is judged, an earlier recording that tells as much is taken instead.
        Raises CheckFailed when there is no publisher or no message.
        """
        wanted = Wanted(self.name, seconds=seconds, step_sec=step_sec)
        return looks.record(self, wanted, hold_sec=hold_sec)

    def publish(self, *messages: Any, timeout_sec: float = 10.0) -> None:
        """Publish messages, once a subscription is there to receive them; wait until they arrived.

        The publisher is RELIABLE and TRANSIENT_LOCAL, which every subscription is content with.
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
        """The first message for which the predicate holds (the first of all without one).

        `after` is called once the subscription stands: what it publishes can't be missed.
        Raises CheckFailed when there is no publisher or no such message in time. Where there were
        others, it speaks of what was `expected`, of the last one, as `seen` puts it in words, and
        gives the `hint` (on that one, if it is a function); so it does where one comes for which
        `never` holds, alone or beside the right one: nothing that comes later changes that. With
        `once`, any second message fails, too, in words for a node that publishes once for each
        message: so publish one message in `after`. Other types than `type_` fail; without it, the
        functions get messages of any standard type.
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
            familiar.remember(watcher.context, *self._answered(recorder))
            if once and (times := len(recorder.messages())) > 1:
                fail(
                    expected='one message for each that your node receives',
                    seen=f'{times} messages',
                    hint='publish once in each call of the callback, and not in a timer',
                )
            return found()[0]

    def _answered(self, recorder: Recorder) -> tuple[Hashable, object]:
        """What is remembered of those that publish here now: that they have answered."""
        return ('answers', self.name), recorder.endpoint_gids()

    def _has_answered(self, watcher: Watcher, recorder: Recorder) -> bool:
        return familiar.is_known(watcher.context, *self._answered(recorder))

    def _expect_none_early(self, watcher: Watcher, recorder: Recorder) -> None:
        """Before anything was sent, nothing comes."""
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
        """Do once more what brings messages; one that comes only now is the one before.

        Not so where others were answered at once: such a node leaves out some.
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
