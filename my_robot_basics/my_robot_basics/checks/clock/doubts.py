"""Whether a busy machine may be the reason why something did not come in time."""

from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.session.pressure import Stopwatch


def doubt_after(watch: Stopwatch, free_sec: float) -> type[CheckFailed]:
    """What to raise: Starved if less than `free_sec` of free time has passed, else CheckFailed."""
    return CheckFailed if watch.free_sec() >= free_sec else Starved
