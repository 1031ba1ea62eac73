"""Exceptions that a node's callbacks raised: each would have ended `rclpy.spin`."""

import time
from collections.abc import Callable, Iterable

from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import fail
from my_robot_basics.graph import graphs
from my_robot_basics.graph.stop_reasons import what_ended_a_thread, what_raised, what_stopped
from my_robot_basics.graph.watcher import Watcher

ENDED = (
    'the node has ended: leave rclpy.shutdown(), destroy_node() and exit() out of its callbacks'
)
GONE_SEC = 0.2
"""How long the graph may take to show that a node has ended, in seconds of free time."""


class CallbackErrors:
    """The exceptions in callbacks since this object was made, of nodes that `live` spins."""

    def __init__(self, node_names: Iterable[str]) -> None:
        """`node_names`: the nodes' full names."""
        self._node_names = [*node_names]
        self._since_ns = time.monotonic_ns()

    def hint(self) -> str:
        """A clause that names one of the exceptions, and what to do; '' if there is none."""
        raised = what_raised(
            name
            for name in self._node_names
            if node_troubles.has_raised_since(name, self._since_ns)
        )
        return fix_first(raised) if raised else ''

    def hint_or_thread(self) -> str:
        """As `hint`; else a clause on what a thread of the notebook raised; or ''.

        Use it only if something is missing: an exception in a thread may do no harm.
        """
        if raised := self.hint():
            return raised
        stopped = what_ended_a_thread()
        return f'{stopped}; fix that first' if stopped else ''

    def why(self, watcher: Watcher) -> str:
        """As `hint`; else a clause on a callback that does not return, or an ended node; or ''."""
        if raised := self.hint():
            return raised
        if stopped := what_stopped(self._node_names):
            return f'{stopped}; fix that first'
        return (
            ENDED if watcher.spin_until_free(self._is_one_gone(watcher), free_sec=GONE_SEC) else ''
        )

    def _is_one_gone(self, watcher: Watcher) -> Callable[[], bool]:
        return lambda: any(graphs.is_gone(watcher, name) for name in self._node_names)

    def expect_none(self) -> None:
        """Raise CheckFailed if a callback raised an exception."""
        if hint := self.hint():
            _fail(hint)


def fix_first(raised: str) -> str:
    """A clause on what a callback raised, and why the student has to fix that first."""
    return f'{raised}; fix that first: rclpy.spin would have ended there'


def expect_none_so_far(node_names: Iterable[str]) -> None:
    """Raise CheckFailed if a callback of the nodes raised since they were started."""
    if raised := what_raised(node_names):
        _fail(fix_first(raised))


def _fail(hint: str) -> None:
    fail(
        expected='callbacks that raise nothing',
        seen='an exception',
        hint=hint,
        cause='a callback raised an exception',
    )
