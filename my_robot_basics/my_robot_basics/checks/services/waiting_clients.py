"""Why a node does not call a service, or does not use the response: one clause for each case."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.services.services import answers_parameters
from my_robot_basics.checks.topics.heartbeat import Heartbeat
from my_robot_basics.exchange.values import type_name
from my_robot_basics.feedback.errors import fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher

WAITS_FOR_LOST = (
    'a request that is sent while there is no server never gets an answer, so let no later target '
    'wait for it: call call_async only if service_is_ready() returns True'
)

_SLEEP = re.compile(r'\bsleep\w*\(')


def waits_for_answer(name: str) -> str:
    """The advice for a node that has sent a request and blocks until it has the response."""
    return (
        f"it called `{name}` inside a callback and waited there: the answer can't be delivered "
        'while the callback runs, or while all threads of its executor wait like this; use '
        'call_async and add_done_callback, or `await` with the callback and the client in one '
        'ReentrantCallbackGroup'
    )


def sleeps(line: str) -> str:
    """The advice for a node that sleeps in that line of a callback."""
    return (
        f'it sleeps inside a callback ({line}), and no other callback runs meanwhile: wait there '
        'neither for a time nor for an answer, which add_done_callback receives when it comes'
    )


def sleeping_call(line: str) -> str:
    """That line of a callback if the callback sleeps there, else ''."""
    return line if _SLEEP.search(line) else ''


def waits_for_server(name: str) -> str:
    """The advice for a node that has not sent a request, and blocks."""
    return (
        f'it waits inside a callback, for `{name}` to be there or for the answer to an earlier '
        'request, and no other callback runs meanwhile; write '
        '`if self.client.service_is_ready():`, which waits for nothing, and ask there with '
        'call_async and add_done_callback'
    )


def counts_nothing(topic_name: str) -> str:
    """The advice for a node that runs, and does not count."""
    return (
        f'the node waits for nothing, and still no timer publishes on {topic_name}: leave that '
        'one as it was given, with its period of 0.1 s'
    )


@dataclass(frozen=True)
class WaitingClient:
    """A client that does not do what it should, and the likely reason."""

    watcher: Watcher
    name: str
    """The service's name."""
    type_: type
    raised: CallbackErrors
    beats: Recorder
    """The topic on which the node counts."""
    goes_on: Callable[[], bool]
    """Returns whether the node goes on running, even after one more message."""
    has_lost: bool = False
    """Whether the server was absent for a while, so that a request may have been lost."""

    def why_not_asked(self, *, asked_on: str, was_away: bool) -> str:
        """What to try if no request comes.

        `was_away`: there was no server when the node should have sent an earlier request.
        """
        if raised := self.raised.hint_or_thread():
            return raised
        ends = services.take_graph(self.watcher.node)
        clients = ends.clients.get(self.name, {})
        types = {each for found in clients.values() for each in found}
        if not clients:
            return ends.why_none(self.name, maker='create_client')
        if type_name(self.type_) not in types:
            asks_for = student_text(' and '.join(sorted(types)))
            return f'it asks for {asks_for}, so compare the type in create_client(…)'
        if self._is_blocked():
            return waits_for_server(self.name)
        if was_away:
            return WAITS_FOR_LOST
        return f'call self.client.call_async(request) for each message on {asked_on}'

    def why_not_published(self) -> str:
        """What to try if the server has responded, and the node publishes nothing."""
        raised = self.raised.hint_or_thread()
        if raised and not _is_of_no_answer(raised):
            return raised
        if self._is_blocked():
            return waits_for_answer(self.name)
        if self.has_lost and not raised:
            return WAITS_FOR_LOST
        return raised or (
            'publish when the answer is there, however late it comes, in the function that '
            'add_done_callback calls (call and spin_until_future_complete get no answer inside a '
            'callback, and an `except` may hide what that function raises)'
        )

    def expect_counts(
        self,
        meanwhile: str,
        send: Callable[[], None],
        *,
        has_asked: Callable[[], bool],
        hint: str = '',
    ) -> None:
        """The node continues to count after `send()`, which may be called again: see `Heartbeat`.

        `meanwhile`: what happens, as a clause; `has_asked()`: whether a request has come; `hint`:
        what to try if the node does not sleep, by default by what it waits for. Raises CheckFailed
        if the count stands still, or Starved if the machine may be the cause.
        """
        heart = Heartbeat(self.watcher, self.beats)
        if not heart.goes_on(send):
            fail(
                expected=f'the count on {self.beats.topic_name} to go on while {meanwhile}',
                seen='it stand still',
                hint=self._why_still(heart.blocking_line, hint, has_asked=has_asked()),
                cause=f'the count on {self.beats.topic_name} stands still',
                doubt=heart.doubt,
            )

    def _why_still(self, line: str, hint: str, *, has_asked: bool) -> str:
        raised = self.raised.hint_or_thread()
        if raised and not _is_of_no_answer(raised):
            return raised
        if call := sleeping_call(line):
            return sleeps(student_text(call))
        if self._counts_nothing():
            return counts_nothing(self.beats.topic_name)
        waits = waits_for_answer if has_asked else waits_for_server
        return hint or waits(self.name)

    def _is_blocked(self) -> bool:
        return not (self.goes_on() or self._counts_nothing())

    def _counts_nothing(self) -> bool:
        """Whether the node answers other requests, and has not counted since the check began."""
        # a node that waits may have another group, which answers: but it has counted before
        return not self.beats.received and all(
            answers_parameters(self.watcher, name) for name in self.beats.publishers()
        )


def _is_of_no_answer(raised: str) -> bool:
    """Whether the exception follows from a wait with a timeout, whose response is None."""
    return 'NoneType' in raised
