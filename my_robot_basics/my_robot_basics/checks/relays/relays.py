"""A node that republishes what it receives: publish on one topic, subscribe to the other."""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.sleeping_callbacks import awake_turns
from my_robot_basics.checks.relays.passage import QUIET_SEC, Passage
from my_robot_basics.checks.relays.relay_endpoints import TIMEOUT_SEC, RelayEndpoints
from my_robot_basics.checks.relays.relay_faults import RelayFaults, what_differs
from my_robot_basics.checks.relays.variety import vary_messages, with_filled_fields
from my_robot_basics.checks.topics.latched import published_before_discovery
from my_robot_basics.checks.values.content import content
from my_robot_basics.feedback.errors import CheckFailed, fail
from my_robot_basics.graph import earlier_waits
from my_robot_basics.graph.watcher import Watcher

EVERYTHING = QoSProfile(depth=5000, reliability=ReliabilityPolicy.BEST_EFFORT)
"""The QoS for a subscription to all messages on the source."""
AGAIN_SEC = 0.1
"""How long to wait for a message to come out before it is sent once more."""
LOST_SEC = 4.0
"""A message that has not come out in this much free time is lost: a right relay never waits."""
TIMES_RAISED = 10
"""After every TIMES_RAISED attempts, the check gives up if a callback has raised."""
OFTEN, SELDOM = 40, 10
"""After OFTEN attempts, a message is sent in every tenth only. A busy machine needs more attempts,
but a node that wrongly ignores its first 100 messages must not receive more than 100."""


def relay(source: str, *, to: str, fields: Sequence[str] = ()) -> 'Relay':
    """A node that republishes the messages of the topic `source` on the topic `to`.

    `relay('/joints', to='/monitor').assert_carries(make_message, qos_profile=offered)`. If only
    some `fields` must stay unchanged, name them: others, such as the stamp, may then differ.
    """
    return Relay(source, to, tuple(fields))


@dataclass(frozen=True)
class Relay:
    """Two topics with the student's node between them; the second one may have any QoS."""

    source: str
    """The topic on which the check publishes."""
    to: str
    """The topic on which the node must republish the messages."""
    fields: tuple[str, ...] = ()
    """The fields that must not change; by default, all of them."""

    def assert_carries(self, make_message: Callable[[], Any], *, qos_profile: QoSProfile) -> None:
        """Each message published on `source` with that profile comes out on `to`, exactly once.

        Its `fields` are the same, nothing else comes out, and no callback raises. `make_message`
        makes a new message in each call; some are sent twice, with zeros, negative or large
        numbers, or without velocities. The first is sent repeatedly until it comes out. Then each
        of `enough.TIMES` in a row (fewer if that takes long) must come out before the next one,
        and so must one after a pause and two right after each other. Raises CheckFailed.
        """
        make_message = with_filled_fields(make_message)
        with Watcher(shared=True) as watcher:
            endpoints = RelayEndpoints(self.source, self.to)
            first = make_message()
            recorder = endpoints.listen(watcher, type(first))
            raised = CallbackErrors(recorder.publishers())
            publisher = endpoints.publish_to_node(watcher, type(first), qos_profile)
            endpoints.expect_one_profile(watcher)
            self._expect_out(watcher, recorder, first, raised, again=publisher)
            watcher.spin_for(QUIET_SEC)
            self._expect_passage(watcher, recorder, publisher, make_message, raised, first)

    def assert_carries_latched(self, make_message: Callable[[], Any], *, times: int = 1) -> None:
        """A latched message published before anyone subscribes comes out on `to`, exactly once.

        `times` times, a new participant publishes a message of `make_message` before it discovers
        any other. The node's subscription must request TRANSIENT_LOCAL. What the last participant
        publishes afterwards must come out, too. Raises CheckFailed.
        """
        make_message = with_filled_fields(make_message)
        with Watcher(shared=True) as watcher:
            endpoints = RelayEndpoints(self.source, self.to)
            recorder = endpoints.listen(watcher, type(make_message()))
            raised = CallbackErrors(recorder.publishers())
            for number in range(times):
                before = len(recorder.received)
                with published_before_discovery(self.source, make_message) as (message, publisher):
                    if number == 0:
                        endpoints.expect_transient_local(watcher)
                        endpoints.expect_type(watcher, recorder.type)
                        endpoints.expect_one_profile(watcher)
                    self._expect_out(watcher, recorder, message, raised, before=before)
                    # if a second copy comes, it comes right after the first
                    watcher.spin_for(QUIET_SEC)
                    count = list(map(self._part, recorder.messages())).count(self._part(message))
                    if count > 1:
                        self._fail(*RelayFaults(copies=count).fault())
                    if number + 1 == times:
                        self._expect_passage(watcher, recorder, publisher, make_message, raised)

    def _expect_passage(
        self,
        watcher: Watcher,
        recorder: Recorder,
        publisher: Publisher,
        make_message: Callable[[], Any],
        raised: CallbackErrors,
        earlier: Any = None,
    ) -> None:
        source_recorder = Recorder(
            watcher, topic_name=self.source, type_=recorder.type, qos_profile=EVERYTHING
        )
        watcher.spin_until(source_recorder.is_connected, timeout_sec=TIMEOUT_SEC)
        watcher.spin_for(QUIET_SEC)
        passage = Passage(
            watcher,
            recorder,
            publish=publisher.publish,
            what=self._part,
            others_publish=source_recorder.has_other_publishers(recorder),
            earlier=earlier,
        )
        messages = vary_messages(make_message)
        if not (carried := passage.carry(messages)).is_whole():
            fault, hint = carried.fault()
            self._fail(fault, raised.why(watcher) or hint, carried.doubt)
        seen = watcher.context, ('passes on after a pause', self), recorder.endpoint_gids()
        if not earlier_waits.is_known(*seen) and passage.loses_after_a_pause(messages):
            self._fail(
                'a message that is not republished when it is the first after a pause',
                raised.why(watcher) or 'publish in every call of the callback, whenever it comes',
            )
        if (copies := passage.copies()) > 1:
            self._fail(*RelayFaults(copies=copies).fault())
        earlier_waits.remember(*seen)
        if passage.loses_one_of_two(messages):
            self._fail(
                'two messages in quick succession of which only one is republished',
                raised.why(watcher)
                or 'publish each in the callback itself, or keep all of them until then',
            )
        if passage.invents(source_recorder.received):
            self._fail(
                f'messages that nobody published on {self.source}',
                'publish in that callback alone, and only the message that it is given',
            )
        raised.expect_none()

    def _fail(self, seen: str, hint: str, doubt: type[CheckFailed] = CheckFailed) -> NoReturn:
        fail(
            expected=f'each message on {self.source} to be republished on {self.to} once, at once',
            seen=seen,
            hint=hint,
            cause=seen,
            doubt=doubt,
        )

    def _expect_out(
        self,
        watcher: Watcher,
        recorder: Recorder,
        message: Any,
        raised: CallbackErrors,
        *,
        before: int = 0,
        again: Publisher | None = None,
    ) -> None:
        """Wait for the message on `to`, after `before` others; send it `again` meanwhile."""
        what, topic_name = self._part(message), self.to
        for times in awake_turns(LOST_SEC, recorder.publishers):
            if again is not None and (times <= OFTEN or times % SELDOM == 0):
                again.publish(message)
            if watcher.spin_until(
                lambda: any(self._part(each) == what for each in recorder.messages()),
                timeout_sec=AGAIN_SEC,
            ):
                return
            if times % TIMES_RAISED == 0 and raised.hint():
                break
        ends, others = RelayEndpoints(self.source, self.to), recorder.messages()[before:]
        has_others, seconds = bool(others), min(times * AGAIN_SEC, LOST_SEC)
        fail(
            expected=f'a message from {self.source} to be republished on {self.to}, unchanged',
            seen=f'only others in {seconds:g} s' if has_others else f'none in {seconds:g} s',
            hint=ends.why_lost(watcher, is_latched=again is None, has_others=has_others)
            + what_differs(others, message, self.fields),
            cause=f'only other messages arrive on {topic_name}'
            if has_others
            else f'no message arrives on {topic_name}',
        )

    def _part(self, message: Any) -> Hashable:
        """The part of a message that must come out unchanged: all of it, or `fields`."""
        if self.fields:
            message = type(message)(**{name: getattr(message, name) for name in self.fields})
        return content(message)
