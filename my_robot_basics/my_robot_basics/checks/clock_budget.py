"""How long a check may drive the robot's clock."""

from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.session.pressure import Stopwatch

BUDGET_SEC = 15.0
"""How long the clock is driven at most, and nbgrader's Validate gives a cell 30 s in all: …"""
BUSY_BUDGET_SEC = 45.0
"""… in a room of its own, time in which processes had to wait for a processor does not count,
within this."""


class ClockBudget:
    """The time since it was made, as a part of what there is."""

    def __init__(self) -> None:
        """Begin."""
        self._watch = Stopwatch()

    def free_sec(self) -> float:
        """How much of that time no process had to wait for a processor."""
        return self._watch.free_sec()

    def wall_sec(self) -> float:
        """How long ago it began."""
        return self._watch.wall_sec()

    def is_used(self, part: float) -> bool:
        """Whether more than this part of the time is used; of 1.0, there is none left."""
        wall_sec = self._watch.wall_sec()
        if wall_sec <= part * BUDGET_SEC:
            return False  # it is asked at each tick, and Linux need not be
        if not is_in_test_room() or wall_sec > part * BUSY_BUDGET_SEC:
            return True
        return self._watch.free_sec() > part * BUDGET_SEC
