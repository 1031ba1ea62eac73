"""A service server that can hold its responses back, and can be absent for a while."""

import time
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node
from rclpy.service import Service

from my_robot_basics.checks.services.sending import send_until_met
from my_robot_basics.feedback.errors import expect

MOST_REQUESTS, MOST_HELD = 500, 10
"""How many requests are too many, and how many responses are sent at once: a client's queue has no
room for more."""
REPEATS_HZ = 5.0
"""How often a client may ask again for each message, in addition to MOST_HELD requests: a busy
machine makes the time long for which responses are held back. So it is a rate: what an idle
machine allows in 1.5 s, which MOST_HELD adds to, must not be too much in 10 s. A loop at 10 Hz has
too many in any time."""
AT_ONCE_NS = 100_000_000
"""More than MOST_HELD requests that are sent within this time are too many, too."""


class HoldingServer:
    """A service server on a node that its owner spins; it serves once `start` was called."""

    def __init__(
        self, node: Node, *, name: str, type_: type, answer: Callable[[Any], Any]
    ) -> None:
        """`answer(request)` returns the response."""
        self.name, self.type, self.answer = name, type_, answer
        self.requests: list[Any] = []
        """All requests in order; the one that makes them MOST_REQUESTS raises CheckFailed."""
        self.published: list[Any] = []
        """All messages that should lead to a request; whoever publishes them adds them."""
        self.sent: list[Any] = []
        """All responses that were sent, in order."""
        self.starts = 0
        """How often `start` was called."""
        self._node = node
        self._service: Service | None = None
        self._holds = False
        self._held_since_sec, self._published_before = 0.0, 0
        self._held: list[tuple[Callable[[Any, Any], None], Any, Any]] = []

    def start(self) -> None:
        """Begin to serve, for the first time or after `stop`."""
        service = self._node.create_service(self.type, self.name, self._take)
        send = service.send_response

        def send_or_hold(response: Any, header: Any) -> None:
            if self._holds:
                self._held.append((send, response, header))
            else:
                self._send(send, response, header)

        # the executor calls it with what _take returns
        service.send_response = send_or_hold  # type: ignore[method-assign]
        self._service = service
        self.starts += 1

    def stop(self) -> None:
        """Stop serving: requests that have no response yet are lost, and so are those to come."""
        if self._service is not None:
            self._node.destroy_service(self._service)
            self._service = None
        self._held.clear()

    def is_there(self) -> bool:
        """Whether it serves now."""
        return self._service is not None

    def hold(self) -> None:
        """From now on, take requests, but hold the responses back until `release`."""
        self._holds = True
        self._held_since_sec, self._published_before = time.monotonic(), len(self.published)

    def release(self, *, reverse: bool = False) -> None:
        """Send the last MOST_HELD responses that were held back, with `reverse` in reverse order.

        From now on, hold nothing back. A client that repeats its requests needs no more of them.
        Raises CheckFailed if there are more than such a client has; see REPEATS_HZ.
        """
        self._holds = False
        held_sec = time.monotonic() - self._held_since_sec
        messages = len(self.published) - self._published_before
        most = MOST_HELD + round(REPEATS_HZ * held_sec * messages)
        is_burst = _are_at_once([header.source_timestamp for *_, header in self._held])
        self._expect_few(is_burst or len(self._held) > most, f'more than {MOST_HELD} at once')
        last = self._held[-MOST_HELD:]
        for send, response, header in reversed(last) if reverse else last:
            self._send(send, response, header)
        self._held = []

    def holds_any(self) -> bool:
        """Whether a response is held back."""
        return bool(self._held)

    def holds_one(self) -> bool:
        """Whether just one response is held back."""
        return len(self._held) == 1

    def holds_many(self) -> bool:
        """Whether a client repeats its request, and nearly MOST_HELD responses are held back."""
        return len(self._held) >= MOST_HELD // 2

    def _send(self, send: Callable[[Any, Any], None], response: Any, header: Any) -> None:
        self.sent.append(response)
        send_until_met(lambda: send(response, header))

    def _take(self, request: Any, _: Any) -> Any:
        self.requests.append(request)
        are_many = len(self.requests) >= MOST_REQUESTS
        self._expect_few(are_many, f'{MOST_REQUESTS} of them')
        return self.answer(request)

    def _expect_few(self, are_many: bool, seen: str) -> None:
        expect(
            not are_many,
            expected=f'a request to {self.name} for each message',
            seen=seen,
            hint='ask once in the callback, not in a loop or a timer',
            cause=f'{self.name} is asked again and again',
        )


def _are_at_once(sent_ns: Sequence[int]) -> bool:
    """Whether more than MOST_HELD of these times are within AT_ONCE_NS."""
    pairs = zip(sent_ns, sent_ns[MOST_HELD:], strict=False)
    return any(later - earlier < AT_ONCE_NS for earlier, later in pairs)
