"""The name of the student's node: launch files and other nodes depend on it."""

from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.graphs import node_names
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
