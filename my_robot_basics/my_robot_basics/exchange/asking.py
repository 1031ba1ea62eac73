"""Put a question to the notebook under test: by way of the grader, or in its own process."""

from typing import Any

from my_robot_basics.exchange import responder, values, wire
from my_robot_basics.feedback.hidden import is_in_test_room


def send(question: str) -> str:
    """Return the reply to a request, as text that nobody has looked at yet."""
    return input(question) if is_in_test_room() else responder.answer(question)


def wait_for_turn() -> None:
    """Return once the notebook has answered something: its process has had a turn."""
    send(wire.request(op='raised', name=wire.THREADS))


def told(question: str) -> Any:
    """Return what the notebook answers, or None where it has no value to tell."""
    try:
        kind, body = wire.parse_reply(send(question))
    except values.WireError:
        return None
    return body if kind == 'ok' else None
