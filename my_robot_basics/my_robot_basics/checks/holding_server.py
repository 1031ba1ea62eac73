"""A server whose answers can be held back, and which can be absent for a while."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.service import Service

from my_robot_basics.checks.sending import send_until_met
from my_robot_basics.feedback.errors import expect

MOST_REQUESTS, MOST_HELD = 500, 10
"""A client that asks once for each message comes to a few. Of more answers at once than its queue
has room for, it would lose some, by chance."""


class HoldingServer:
    """Serves as soon as `start` was called, on a node that somebody else spins."""

    def __init__(
        self, node: Node, *, name: str, type_: type, answer: Callable[[Any], Any]
    ) -> None:
        """`answer(request)` returns the response."""
        self.name, self.type, self.answer = name, type_, answer
        self.requests: list[Any] = []
        """All that it was asked, in order; MOST_REQUESTS of them raise CheckFailed."""
        self.sent: list[Any] = []
        """All responses that have left."""
        self.starts = 0
        """How often it was started."""
        self._node = node
        self._service: Service | None = None
        self._holds = False
        self._held: list[tuple[Callable[[Any, Any], None], Any, Any]] = []

    def start(self) -> None:
        """Serve again, after `stop`."""
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
        """Be absent: a request that comes now is lost, and so is one that has no answer yet."""
        if self._service is not None:
            self._node.destroy_service(self._service)
            self._service = None
        self._held.clear()

    def is_there(self) -> bool:
        """Whether it serves now."""
        return self._service is not None

    def hold(self) -> None:
        """Take requests, and keep the answers until `release`."""
        self._holds = True

    def release(self, *, reverse: bool = False) -> None:
        """Send the answers that were kept, with `reverse` the last one first; hold no longer.

        Raises CheckFailed where there are more than MOST_HELD.
        """
        self._holds = False
        self._expect_few(len(self._held), MOST_HELD + 1, f'more than {MOST_HELD} at once')
        for send, response, header in reversed(self._held) if reverse else self._held:
            self._send(send, response, header)
        self._held = []

    def holds_any(self) -> bool:
        """Whether an answer is kept back."""
        return bool(self._held)

    def holds_many(self) -> bool:
        """Whether so many answers are kept back that a client which asks again needs them soon."""
        return len(self._held) >= MOST_HELD // 2

    def _send(self, send: Callable[[Any, Any], None], response: Any, header: Any) -> None:
        self.sent.append(response)
        send_until_met(lambda: send(response, header))

    def _take(self, request: Any, _: Any) -> Any:
        self.requests.append(request)
        self._expect_few(len(self.requests), MOST_REQUESTS, f'{MOST_REQUESTS} of them')
        return self.answer(request)

    def _expect_few(self, count: int, too_many: int, seen: str) -> None:
        expect(
            count < too_many,
            expected=f'a request to {self.name} for each message',
            seen=seen,
            hint='ask once in the callback, not in a loop or a timer',
            cause=f'{self.name} is asked again and again',
        )
