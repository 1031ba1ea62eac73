"""Whether a machine that is too busy may be to blame for what did not come in time."""

from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.session.pressure import Stopwatch


def doubt_after(watch: Stopwatch, free_sec: float) -> type[CheckFailed]:
    """What to raise: Starved where the machine gave less time than was to be waited."""
    return CheckFailed if watch.free_sec() >= free_sec else Starved
