"""Send a request to the notebook under test: through the grader, or in the same process."""

from typing import Any

from my_robot_basics.exchange import responder, values, wire
from my_robot_basics.feedback.hidden import is_in_test_room


def send(question: str) -> str:
    """Return the reply to a request, as text that is not validated yet."""
    return input(question) if is_in_test_room() else responder.answer(question)


def wait_for_turn() -> None:
    """Return once the notebook has answered a request: its process got processor time."""
    send(wire.request(op='raised', name=wire.THREADS))


def reply_value(question: str) -> Any:
    """Return the value that the notebook answers, or None if its reply has none."""
    try:
        kind, body = wire.parse_reply(send(question))
    except values.WireError:
        return None
    return body if kind == 'ok' else None
