"""How long a check may drive the robot's clock."""

from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.session.pressure import Stopwatch

BUDGET_SEC = 15.0
"""How long the clock is driven at most: nbgrader's *Validate* gives a cell 30 s in all."""
BUSY_BUDGET_SEC = 45.0
"""The same in a test's room, in wall time: there, time in which processes had to wait for a
processor does not count towards BUDGET_SEC."""


class ClockBudget:
    """The time since this object was made, compared with how long the clock may be driven."""

    def __init__(self) -> None:
        """Start to measure."""
        self._watch = Stopwatch()

    def free_sec(self) -> float:
        """Seconds since the start in which no process had to wait for a processor."""
        return self._watch.free_sec()

    def wall_sec(self) -> float:
        """Seconds of wall time since the start."""
        return self._watch.wall_sec()

    def is_used(self, part: float) -> bool:
        """Whether more than this part of the budget is used; with 1.0, whether none is left."""
        wall_sec = self._watch.wall_sec()
        if wall_sec <= part * BUDGET_SEC:
            return False  # called at each tick: most calls need no figures from Linux
        if not is_in_test_room() or wall_sec > part * BUSY_BUDGET_SEC:
            return True
        return self._watch.free_sec() > part * BUDGET_SEC
