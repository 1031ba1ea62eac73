"""Match a node's messages with the responses sent to it: each needs a response of its own."""

import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.services.services import answers_parameters
from my_robot_basics.checks.values.message_text import message_text
from my_robot_basics.feedback.errors import fail
from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.graph.watcher import Watcher

MadeOf = Callable[[Any, Any], bool]
"""A function of a message and a response: whether the node made the message from the response."""
OWED_SEC = 0.5
"""How long to wait for an outstanding request or message of a node, in s of free time."""
EARLIER_LOOKS = 3
"""How often to ask a node whether it has handled earlier messages; it has a second each time."""


def made_of_none(_message: Any, _response: Any) -> bool:
    """Return False: no message is made from any response."""
    return False


def wait_for_requests(watcher: Watcher, requests: Sequence[Any], most: int) -> None:
    """Wait for `most` requests, one for each published message; for each OWED_SEC at most.

    The last may be late: a client may keep a repeated message until the first one is answered.
    """
    before = -1
    while before < len(requests) < most:
        before = len(requests)
        watcher.spin_until_free(lambda: len(requests) > before, free_sec=OWED_SEC)  # noqa: B023


def wait_for_earlier(watcher: Watcher, node_names: Iterable[str]) -> None:
    """Wait until these nodes have handled the message that a cell before may just have sent.

    On a busy machine, its request would come after the check's first message, as one too many. An
    executor takes messages and responses before a request for parameters, so the first answer
    comes after the node's request, and the second after what it makes of the response. At
    grading, no such cell is run.
    """
    for name in () if is_in_test_room() else node_names:
        # a node that blocks does not answer, and the check goes on without
        if any(answers_parameters(watcher, name) for _ in range(EARLIER_LOOKS)):
            answers_parameters(watcher, name)


class MadeMessages:
    """The messages on a topic since `begin`, matched with the responses of a server."""

    def __init__(self, watcher: Watcher, recorder: Recorder, sent: Sequence[Any]) -> None:
        """`sent` is the list of responses, to which the server appends."""
        self._watcher, self._recorder, self._sent = watcher, recorder, sent
        self._left: list[Any] = []
        self._others: list[Any] = []
        self._read = self._taken = 0
        self._began_ns = 0

    def begin(self) -> None:
        """Count only messages that are sent from now on; later calls change nothing.

        A late-joining subscription may receive messages that were made for an earlier server.
        """
        self._began_ns = self._began_ns or time.time_ns()

    def others(self, made_of: MadeOf) -> list[Any]:
        """The messages that match no response, or only one that another message matches."""
        self._look(made_of)
        return self._others

    def messages(self) -> list[Any]:
        """All messages since `begin`, in order."""
        return [message for message, sent_ns in self._recorder.received if self._counts(sent_ns)]

    def was_sent_before(self, time_ns: int, message: Any) -> bool:
        """Whether this very message was sent before that wall time."""
        received = self._recorder.received
        return any(each is message and sent_ns < time_ns for each, sent_ns in received)

    def expect_no_others(self, made_of: MadeOf, *, hint: Callable[[Any], str]) -> None:
        """Each message so far is made from a response of its own. Raises CheckFailed.

        `hint(message)` says what is wrong with a message for which this is not so.
        """
        topic_name = self._recorder.topic_name
        if others := self.others(made_of):
            fail(
                expected=f'one message on {topic_name} for each response, and no other',
                seen=message_text(others[0]),
                hint=hint(others[0]),
                cause=f'a message on {topic_name} that should not be',
            )

    def wait_for_rest(self, made_of: MadeOf, *, leads: Callable[[Any], bool]) -> None:
        """Wait up to OWED_SEC for the message of each response that `leads` to one.

        Otherwise the next check might receive it.
        """

        def is_all() -> bool:
            self._look(made_of)
            return not any(map(leads, self._left))

        self._watcher.spin_until_free(is_all, free_sec=OWED_SEC)

    def _look(self, made_of: MadeOf) -> None:
        self._left += self._sent[self._taken :]
        self._taken = len(self._sent)
        new, self._read = self._recorder.received[self._read :], len(self._recorder.received)
        for message, sent_ns in new:
            if self._counts(sent_ns) and not self._use(message, made_of):
                self._others.append(message)

    def _counts(self, sent_ns: int) -> bool:
        return sent_ns >= self._began_ns

    def _use(self, message: Any, made_of: MadeOf) -> bool:
        for number, response in enumerate(self._left):
            if made_of(message, response):
                del self._left[number]
                return True
        return False
