"""The name of the student's node: launch files and other nodes depend on it."""

from collections.abc import Sequence

from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.graphs import node_names
from my_robot_basics.graph.not_running import why_not_running
from my_robot_basics.graph.watcher import Watcher

NAME_SEC = 1.0
"""How long to look for a name, in seconds of free time. It is short because an earlier check has
already discovered the node."""


def expect_node(name: str) -> None:
    """A node of that name runs, in any namespace. Raises CheckFailed.

    Call it after a check that has discovered an endpoint of the node.
    """

    def runs() -> bool:
        return any(each.rpartition('/')[2] == name for each in node_names(watcher.node))

    with Watcher(shared=True) as watcher:
        expect(
            watcher.spin_until_free(runs, free_sec=NAME_SEC),
            expected=f'a node named {name}',
            seen=student_text(', '.join(sorted({*node_names(watcher.node)}))) or 'none',
            hint=f"write `super().__init__('{name}')`, with this name",
            cause='the node has another name',
        )


def why_absent(full_name: str, others: Sequence[str]) -> str:
    """What to do if there is no node of that full name, but there are these others."""
    if not others:
        return why_not_running()
    name = full_name.strip('/')
    if any(other.endswith(full_name) for other in others):
        return f'the name {name} is right, so leave the namespace out of super().__init__(…)'
    return f"if that is yours, write super().__init__('{name}'), letter for letter"
