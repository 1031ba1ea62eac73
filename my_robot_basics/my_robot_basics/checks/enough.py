"""How many messages in a row have to come out of a node."""

from my_robot_basics.session.pressure import Stopwatch

TIMES = 120
"""Messages in a row that have to come out: one that is left out each hundredth time is among
them. …"""
FEWEST = 24
"""… So many will do after SOME_SEC, …"""
SOME_SEC = 2.5
FEWEST_SLOW = 12
"""… So many of a slow node or machine will do after LONG_SEC: that finds each eleventh, too."""
LONG_SEC = 4.0


def fewest_in_a_row(row: Stopwatch) -> int:
    """How many messages in a row are enough after so long."""
    wall_sec = row.wall_sec()
    if wall_sec < SOME_SEC:
        return TIMES
    return FEWEST if wall_sec < LONG_SEC else FEWEST_SLOW
