"""The check's own service server (fast, slow or absent) for a client in the student's node."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from rclpy.publisher import Publisher

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.services import responses
from my_robot_basics.checks.services.holding_server import HoldingServer
from my_robot_basics.checks.services.late_answers import comes_in_time
from my_robot_basics.checks.services.responses import MadeMessages, MadeOf, made_of_none
from my_robot_basics.checks.services.sole_server import expect_no_other, wait_until_known
from my_robot_basics.checks.services.waiting_clients import WaitingClient
from my_robot_basics.checks.topics import heartbeat
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.checks.values.message_text import message_text
from my_robot_basics.feedback.errors import expect, fail
from my_robot_basics.graph.watcher import Watcher

TIMEOUT_SEC = 4.0
"""How long to wait for a request, or for a message on `to`, in s of free time."""
QUIET_SEC = 0.5
"""How long to wait for a message that must not come, in s of wall time."""
AGAIN_SEC = 0.5
"""How often a message is published again until its request comes: a new client may lose one."""
Hint = Callable[[Any], str]


@contextmanager
def serve(
    name: str, type_: type, answer: Callable[[Any], Any], *, asked_on: str, to: str, alive: str
) -> Iterator['Server']:
    """The check's own server of a service, for the duration of a with statement.

    `answer(request)` returns the response. For each message on the topic `asked_on`, the student's
    node sends a request, and publishes what it makes of the response on the topic `to`. It counts
    on the topic `alive` at 10 Hz: if the count stops, a callback blocks the node. Raises
    CheckFailed if `to` or `alive` has no publisher, or another node serves.

        with serve('/solve_ik', SolveIK, ik.solve, asked_on='/target_point',
                   to='/kinematics/joint_states', alive='/ik_client/alive') as server:
            server.hold()
            server.ask(Point(x=1.0), is_it=lambda request: request.target.x == 1.0)
            server.expect_alive('the server takes its time', Point(x=1.5))
            server.release()
            server.expect(is_right, expected='…', hint=lambda message: '…')
    """
    served: dict[str, Any] = {'name': name, 'type_': type_, 'answer': answer, 'asked_on': asked_on}
    with Watcher(shared=True) as watcher:
        answers, beats = (Topic(topic_name).listen(watcher) for topic_name in (to, alive))
        server = Server(watcher, answers=answers, beats=beats, **served)
        server.expect_alone()
        server.start()
        yield server
        server.wait_for_repeated()
        server.expect_alone()


class Server(HoldingServer):
    """The server that `serve` yields, for the duration of its with statement."""

    def __init__(
        self, watcher: Watcher, *, asked_on: str, answers: Recorder, beats: Recorder, **served: Any
    ) -> None:
        """`served`: the other arguments of HoldingServer."""
        super().__init__(watcher.node, **served)
        self.asked_on = asked_on
        self._watcher, self._answers, self._beats = watcher, answers, beats
        self._raised = CallbackErrors({*answers.publishers(), *beats.publishers()})
        self.made = MadeMessages(watcher, answers, self.sent)
        """The messages on `to`, matched with the responses."""
        self._publisher: Publisher | None = None
        self._seen = self._known_starts = 0

    def publish(self, message: Any, *, anew: bool = True) -> None:
        """Publish a message that should lead to a request; if `anew`, `expect` begins there."""
        if self._publisher is None:
            self._publisher = Topic(self.asked_on).meet(self._watcher, type(message))
            responses.wait_for_earlier(self._watcher, self._answers.publishers())
        if anew:
            self._seen = len(self._answers.received)
            self.made.begin()
        self.published.append(message)
        self._publisher.publish(message)

    def wait_for_repeated(self) -> None:
        """Wait for outstanding requests: without a server, they would never be answered."""
        responses.wait_for_requests(self._watcher, self.requests, len(self.published))

    def stop(self) -> None:
        """Destroy the server; return when the student's node has had time to notice."""
        super().stop()
        wait_until_known(self._watcher)

    def ask(
        self, message: Any, *, is_it: Callable[[Any], bool], hint: str = 'ask for what arrived'
    ) -> Any:
        """Publish a message on `asked_on`; return the first new request for which `is_it` holds.

        Raises CheckFailed if none comes in TIMEOUT_SEC of free time.
        """
        before = len(self.requests)

        def found() -> list[Any]:
            return [request for request in self.requests[before:] if is_it(request)]

        self.publish(message)
        for _ in range(round(TIMEOUT_SEC / AGAIN_SEC)):
            if self._watcher.spin_until_free(lambda: bool(found()), free_sec=AGAIN_SEC):
                self._known_starts = self.starts
                return found()[0]
            if self._known_starts < self.starts:
                self.publish(message)
        others = self.requests[before:]
        if not (others and self._goes_on()):  # others may be late requests of a node that blocks
            was_away = 1 < self.starts != self._known_starts
            hint = self._client().why_not_asked(asked_on=self.asked_on, was_away=was_away)
        fail(
            expected=f'a request to {self.name} for the message on {self.asked_on}',
            seen=message_text(others[-1]) if others else f'none in {TIMEOUT_SEC:g} s',
            hint=hint,
            cause=f'{self.name} is {"asked for something else" if others else "not asked"}',
        )

    def expect(
        self, is_right: Callable[[Any], bool], *, expected: str, hint: Hint, cause: str = ''
    ) -> Any:
        """Return the first message on `to` since the last `publish` for which `is_right` holds.

        `hint(message)` says what is wrong with another message, `cause` in a few words. Raises
        CheckFailed if no right one comes in TIMEOUT_SEC of free time.
        """

        def received() -> list[Any]:
            return self._answers.messages()[self._seen :]

        comes, names = (lambda: any(map(is_right, received()))), self._answers.publishers()
        if comes_in_time(self._watcher, comes, free_sec=TIMEOUT_SEC, names=names):
            self._raised.expect_none()
            return next(filter(is_right, received()))
        others, wrong = received(), cause or f'a wrong message on {self._answers.topic_name}'
        fail(
            expected=f'{expected} on {self._answers.topic_name}',
            seen=message_text(others[-1]) if others else f'none in {TIMEOUT_SEC:g} s',
            hint=hint(others[-1]) if others else self._client().why_not_published(),
            cause=wrong if others else f'{self.name} has answered, and nothing is published',
        )

    def expect_nothing(self, *, hint: Hint, made_of: MadeOf = made_of_none) -> None:
        """In QUIET_SEC, no message on `to` but those of `MadeMessages`. Raises CheckFailed."""
        self._watcher.spin_for(QUIET_SEC)
        others = self.made.others(made_of)
        expect(
            not others,
            expected=f'no message on {self._answers.topic_name}',
            seen=message_text(others[-1]) if others else '',
            hint=hint(others[-1]) if others else '',
            cause=f'a message on {self._answers.topic_name} that should not be',
        )
        self._raised.expect_none()

    def record_count(self) -> Recording | None:
        """Record the count on `alive` on the node's clock: see `heartbeat.record`."""
        return heartbeat.record(self._watcher, self._beats)

    def expect_alive(self, meanwhile: str, message: Any) -> None:
        """As `expect_alive_during` of publishing a message. Raises CheckFailed, Starved."""
        self.expect_alive_during(meanwhile, lambda: self.publish(message))

    def expect_alive_during(
        self, meanwhile: str, send: Callable[[], None], *, hint: str = ''
    ) -> None:
        """The node continues to count on `alive` after `send()`, which may be called again.

        `meanwhile`: what happens, as a clause. Raises CheckFailed, Starved.
        """
        self._client().expect_counts(meanwhile, send, has_asked=self.holds_any, hint=hint)
        self.expect_alone()

    def expect_alone(self) -> None:
        """No other node serves this service. Raises CheckFailed."""
        expect_no_other(self._watcher, self.name, own=int(self.is_there()))

    def _client(self) -> WaitingClient:
        goes_on = partial(self._goes_on, lambda: self.publish(self.published[-1]))
        seen = self._watcher, self.name, self.type, self._raised, self._beats
        return WaitingClient(*seen, goes_on, has_lost=self.starts > 1)

    def _goes_on(self, send: Callable[[], None] = lambda: None) -> bool:
        return heartbeat.Heartbeat(self._watcher, self._beats).goes_on(send)
