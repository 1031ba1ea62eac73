"""Wait for a server to appear, and judge whether a missing one is the student's fault."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from my_robot_basics.checks.clock.doubts import doubt_after
from my_robot_basics.exchange.values import type_name
from my_robot_basics.feedback.errors import CheckFailed, expect
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import earlier_waits, graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

SERVER_SEC = 10.0
"""How long to wait for a server, in seconds of free time: a program that was just started may have
got no processor yet."""


@dataclass(frozen=True)
class NoServer:
    """What is known about a server that did not appear."""

    seen: str
    """How long the check waited in vain, in words."""
    doubt: type[CheckFailed]
    """What to raise: Starved if the machine may be to blame, else CheckFailed."""


def expect_type(
    name: str, type_: type, found: Mapping[str, Collection[str]], *, maker: str
) -> None:
    """Expect all servers of a name to have the type `type_`. Raises CheckFailed.

    `found`: the servers' types by node name; `maker`: the function or class of rclpy with which a
    node makes such a server.
    """
    wanted = type_name(type_)
    types = sorted({each for types in found.values() for each in types})
    expect(
        types == [wanted],
        expected=f'a server of {name} for {wanted}',
        seen=f'one for {student_text(" and ".join(types))}',
        hint=f'compare the type in {maker}(…)',
        cause=f'{name} has another type',
    )


def wait_for_server(watcher: Watcher, name: str, is_there: Callable[[], bool]) -> NoServer | None:
    """Wait for a server, but only SETTLED_SEC if the notebook says that none can appear.

    Return None if it appeared. The notebook is not asked if the server of that name has appeared
    before in this grade cell, and is still there.
    """
    appeared = ('server', name), True
    if earlier_waits.is_known(watcher.context, *appeared) and is_there():
        return None
    if graphs.is_settled(watcher):
        timeout_sec, doubt = graphs.SETTLED_SEC, CheckFailed
        came = watcher.spin_until(is_there, timeout_sec=timeout_sec)
    else:
        timeout_sec, watch = SERVER_SEC, Stopwatch()
        came = watcher.spin_until_free(is_there, free_sec=timeout_sec)
        doubt = doubt_after(watch, timeout_sec)
    if came:
        earlier_waits.remember(watcher.context, *appeared)
        return None
    return NoServer(graphs.none_in(timeout_sec), doubt)
