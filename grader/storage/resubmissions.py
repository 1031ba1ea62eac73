"""What handing in again is bound by: the table [resubmissions] of gradebook/deadlines.toml.

    [resubmissions]
    per_hour = 6            # so many submissions of a lesson are graded for a student in an hour
    in_total = 30           # and so many in all; what is more waits, and is kept
    hidden_inputs = "anew"  # or "kept", the default: each student's own, at each attempt

`./course serve` counts; whoever runs `./course grade` has decided. By default nothing is bound.
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
    """Return what a table says. Raises ValueError with what is wrong in it."""
    if strange := sorted(table.keys() - {'per_hour', 'in_total', 'hidden_inputs'}):
        raise ValueError(f'{strange[0]!r} is not known')
    for key in ('per_hour', 'in_total'):
        value = table.get(key, 1)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise ValueError(f'{key} is no whole number from 1 on')
    if table.get('hidden_inputs', KEPT) not in (KEPT, ANEW):
        raise ValueError(f'hidden_inputs is neither "{KEPT}" nor "{ANEW}"')
    return ResubmissionRules(**table)
