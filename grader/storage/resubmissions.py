"""Limits on handing in again: the table [resubmissions] of gradebook/deadlines.toml.

    [resubmissions]
    per_hour = 6            # submissions of a lesson that are graded for a student in an hour
    in_total = 30           # the same in all; further submissions wait, and are kept
    hidden_inputs = "anew"  # or "kept", the default: the same for a student at each attempt

Only `./course serve` applies the limits; `./course grade` does not. By default there are none.
"""

from dataclasses import dataclass
from typing import Any

KEPT, ANEW = 'kept', 'anew'


@dataclass(frozen=True)
class ResubmissionRules:
    """What the table says."""

    per_hour: int | None = None
    in_total: int | None = None
    hidden_inputs: str = KEPT


def read_rules(table: dict[str, Any]) -> ResubmissionRules:
    """Return the rules in a table. Raises ValueError if something in it is wrong."""
    if strange := sorted(table.keys() - {'per_hour', 'in_total', 'hidden_inputs'}):
        raise ValueError(f'{strange[0]!r} is not a name that [resubmissions] can have')
    for key in ('per_hour', 'in_total'):
        value = table.get(key, 1)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise ValueError(f'{key} must be a whole number, 1 or more')
    if table.get('hidden_inputs', KEPT) not in (KEPT, ANEW):
        raise ValueError(f'hidden_inputs must be "{KEPT}" or "{ANEW}"')
    return ResubmissionRules(**table)
