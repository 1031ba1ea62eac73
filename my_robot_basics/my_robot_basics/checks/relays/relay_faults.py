"""The faults of a relay: messages late, lost or copied, and what to tell the student."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.relays.variety import PLAIN
from my_robot_basics.feedback.errors import CheckFailed

CALLBACK = 'publish in every call of the callback'
FEWEST_OF_A_KIND = 3
"""This many lost messages of one kind are no coincidence, even if a busy machine allowed few."""


@dataclass(frozen=True)
class RelayFaults:
    """How many messages were late, which of them never came out, and which came out repeatedly.

    A message is late if it did not come out before the next one was sent.
    """

    late: int = 0
    lost: tuple[str, ...] = ()
    """The kind of each message that never came out."""
    copies: int = 1
    """How often a message came out if one came out repeatedly, otherwise 1."""
    doubt: type[CheckFailed] = CheckFailed
    """What to raise: Starved if messages of others on a busy machine may be the reason."""

    def is_whole(self) -> bool:
        """Whether enough messages came out in time, each exactly once."""
        return not self.late and self.copies == 1

    def fault(self) -> tuple[str, str]:
        """What was seen, and what to try."""
        if self.lost and (len(self.lost) > 1 or self.late == len(self.lost)):
            kinds = set(self.lost)
            if len(self.lost) >= FEWEST_OF_A_KIND and len(kinds) == 1 and PLAIN not in kinds:
                return f'messages that are not republished: those {kinds.pop()}', (
                    f'{CALLBACK}, and the message as it is, whatever it holds'
                )
            return (
                'messages that are not republished',
                f'{CALLBACK}: some messages are left out, or changed',
            )
        if self.late:
            return 'a message that is republished only when the next one arrives', (
                'publish the message that your callback is given, not the one before'
            )
        return f'a message that is republished {self.copies} times', (
            'subscribe once, and publish once in each call of the callback'
        )


def what_differs(others: Sequence[Any], sent: Any, fields: Sequence[str] = ()) -> str:
    """Name the fields that differ, as a clause; '' if in each message all or none of them do.

    `fields` are those to compare; by default, all of the message.
    """
    names = fields or tuple(sent.get_fields_and_field_types())
    for received in others:
        wrong = _differing(names, received, sent)
        if 0 < len(wrong) < len(names):
            inner = (_inside(name, getattr(received, name), getattr(sent, name)) for name in wrong)
            return f'; not the same: {", ".join(inner)}'
    return ''


def _differing(names: Sequence[str], received: Any, sent: Any) -> list[str]:
    return [name for name in names if getattr(received, name) != getattr(sent, name)]


def _inside(name: str, received: Any, sent: Any) -> str:
    """The field's name, or that of its only differing subfield, such as header.frame_id."""
    if not hasattr(sent, 'get_fields_and_field_types'):
        return name
    wrong = _differing(tuple(sent.get_fields_and_field_types()), received, sent)
    return f'{name}.{wrong[0]}' if len(wrong) == 1 else name
