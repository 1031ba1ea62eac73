"""Wait for a node on a busy machine, but not for one whose callback sleeps."""

from collections.abc import Callable

from my_robot_basics.exchange import node_troubles
from my_robot_basics.graph.watcher import LOOK_EVERY_SEC, Watcher
from my_robot_basics.session.pressure import Stopwatch, free_turns

PATIENT_SEC, ASLEEP_SEC = 1.0, 1.5
"""After how long (wall time) the notebook is asked whether a callback sleeps, and how long that
has to sleep on to be late. A sleep of 2 s is in time, and one of 3 s is not, on any machine."""


class PatientWait:
    """Waits for what a node does in free time, unless a callback that blocks the node sleeps.

    A sleep lasts as long on a busy machine as on any other: there, free time is shorter.
    """

    def __init__(self, watcher: Watcher, node_name: str) -> None:
        """`node_name`: the node's full name."""
        self._watcher, self._node_name = watcher, node_name
        self.slept_in = 0, ''
        """The line at which a callback has slept too long, number and text; or 0, ''."""

    def until(self, is_done: Callable[[], bool], *, free_sec: float) -> bool:
        """Spin until `is_done()`, at most `free_sec` of free time; return whether it is done.

        It returns False as soon as a callback has slept through PATIENT_SEC and ASLEEP_SEC.
        """
        watch = Stopwatch()
        for _ in free_turns(free_sec):
            if self._watcher.spin_until(is_done, timeout_sec=min(LOOK_EVERY_SEC, free_sec)):
                return True
            if watch.wall_sec() >= PATIENT_SEC:
                self.slept_in = node_troubles.sleeps_on(self._node_name, ASLEEP_SEC)
                if self.slept_in[1]:
                    return False
        return False
