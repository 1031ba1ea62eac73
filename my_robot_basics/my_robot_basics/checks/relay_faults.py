"""What became of messages that went through a node: late, lost, copied, and what to say of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.variety import PLAIN

CALLBACK = 'publish in every call of the callback'
FEWEST_OF_A_KIND = 3
"""Two may be of one kind by chance, where a busy machine leaves no time for more."""


@dataclass(frozen=True)
class RelayFaults:
    """What was amiss: how many messages were late, which of them never came, and what came twice.

    Each that is late was not there before the next one was sent.
    """

    late: int = 0
    lost: tuple[str, ...] = ()
    """The kind of each message that never came out."""
    copies: int = 1
    """How often one came out at most."""

    def is_whole(self) -> bool:
        """Whether enough came out in time, and each once."""
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
    """Which fields (of these, or of all) differ while others are right, as a clause; or ''."""
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
    """The field of that name, or the one in it that alone differs: header.frame_id."""
    if not hasattr(sent, 'get_fields_and_field_types'):
        return name
    wrong = _differing(tuple(sent.get_fields_and_field_types()), received, sent)
    return f'{name}.{wrong[0]}' if len(wrong) == 1 else name
