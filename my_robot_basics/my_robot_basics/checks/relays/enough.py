"""How many messages in a row a relaying node has to republish."""

from my_robot_basics.session.pressure import Stopwatch

TIMES = 120
"""How many messages in a row are always enough: they show it if every hundredth is left out."""
FEWEST = 24
"""How many are enough after SOME_SEC of wall time."""
SOME_SEC = 2.5
FEWEST_SLOW = 12
"""How many are enough after LONG_SEC, for a slow node or machine: this shows if every eleventh is
left out."""
LONG_SEC = 4.0


def fewest_in_a_row(row: Stopwatch) -> int:
    """How many messages in a row are enough; `row`: the time since the row began."""
    wall_sec = row.wall_sec()
    if wall_sec < SOME_SEC:
        return TIMES
    return FEWEST if wall_sec < LONG_SEC else FEWEST_SLOW
