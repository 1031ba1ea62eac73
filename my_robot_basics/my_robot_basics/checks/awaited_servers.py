"""How long a check waits for a server to appear, and what it makes of one that does not."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from my_robot_basics.checks.doubts import doubt_after
from my_robot_basics.exchange.values import type_name
from my_robot_basics.feedback.errors import CheckFailed, expect
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

SERVER_SEC = 10.0
"""How long to wait, of time that was free: a program that was started just now may have had no
processor."""


@dataclass(frozen=True)
class NoServer:
    """No server has come."""

    seen: str
    """How long nothing was seen, in words."""
    doubt: type[CheckFailed]
    """What to raise: the machine may be to blame."""


def expect_type(
    name: str, type_: type, found: Mapping[str, Collection[str]], *, maker: str
) -> None:
    """The servers of a name that were found, types by node, are of one type. Raises CheckFailed.

    `maker`: the function or class of rclpy with which a node makes such a server.
    """
    wanted = type_name(type_)
    types = sorted({each for types in found.values() for each in types})
    expect(
        types == [wanted],
        expected=f'a server of {name} for {wanted}',
        seen=f'one for {theirs(" and ".join(types))}',
        hint=f'compare the type in {maker}(…)',
        cause=f'{name} has another type',
    )


def wait_for_server(watcher: Watcher, is_there: Callable[[], bool]) -> NoServer | None:
    """Wait for a server, and not for long where the notebook says that none can come.

    None where it is there.
    """
    if graphs.is_settled(watcher):
        timeout_sec, doubt = graphs.SETTLED_SEC, CheckFailed
        came = watcher.spin_until(is_there, timeout_sec=timeout_sec)
    else:
        timeout_sec, watch = SERVER_SEC, Stopwatch()
        came = watcher.spin_until_free(is_there, free_sec=timeout_sec)
        doubt = doubt_after(watch, timeout_sec)
    return None if came else NoServer(graphs.none_in(timeout_sec), doubt)
