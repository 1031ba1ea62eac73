"""What the callbacks of a node raised: `rclpy.spin` would have ended there."""

from collections.abc import Callable, Iterable

from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import fail
from my_robot_basics.graph import graphs
from my_robot_basics.graph.raised import what_ended_a_thread, what_raised, what_stopped
from my_robot_basics.graph.watcher import Watcher

ENDED = (
    'the node has ended: leave rclpy.shutdown(), destroy_node() and exit() out of its callbacks'
)
GONE_SEC = 0.2
"""How long the graph may take to tell that a node has ended."""


class CallbackErrors:
    """The exceptions of nodes' callbacks since this was made, where live spins them."""

    def __init__(self, node_names: Iterable[str]) -> None:
        """`node_names`: the nodes' full names."""
        self._before = {name: node_troubles.times_raised(name) for name in node_names}

    def hint(self) -> str:
        """A clause that names one of them, and what to do; or ''."""
        names = [n for n, times in self._before.items() if node_troubles.times_raised(n) > times]
        raised = what_raised(names)
        return fix_first(raised) if raised else ''

    def hint_or_thread(self) -> str:
        """The same; or a clause on what a thread of the notebook's own raised, or ''.

        It tells where to look, where something is missing: a thread may end without any harm.
        """
        if raised := self.hint():
            return raised
        stopped = what_ended_a_thread()
        return f'{stopped}; fix that first' if stopped else ''

    def why(self, watcher: Watcher) -> str:
        """As `hint`; else a clause on one that does not return, or on a node that ended; or ''."""
        if raised := self.hint():
            return raised
        if stopped := what_stopped(self._before):
            return f'{stopped}; fix that first'
        return (
            ENDED if watcher.spin_until_free(self._is_one_gone(watcher), free_sec=GONE_SEC) else ''
        )

    def _is_one_gone(self, watcher: Watcher) -> Callable[[], bool]:
        return lambda: any(graphs.is_gone(watcher, name) for name in self._before)

    def expect_none(self) -> None:
        """Raise CheckFailed where there was one."""
        if hint := self.hint():
            _fail(hint)


def fix_first(raised: str) -> str:
    """A clause on what a callback raised, and why nothing else is told before that is fixed."""
    return f'{raised}; fix that first: rclpy.spin would have ended there'


def expect_none_so_far(node_names: Iterable[str]) -> None:
    """No callback of the nodes has raised since they were started. Raises CheckFailed."""
    if raised := what_raised(node_names):
        _fail(fix_first(raised))


def _fail(hint: str) -> None:
    fail(
        expected='callbacks that raise nothing',
        seen='an exception',
        hint=hint,
        cause='a callback raised an exception',
    )
