"""Whether an action client goes on with its work while there is no server for it."""

from typing import Any

from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.duration import Duration

from my_robot_basics.checks.actions.served_action import ServedAction
from my_robot_basics.checks.clock.barriers import NOTHING
from my_robot_basics.checks.clock.doubts import doubt_after
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import CheckFailed, fail
from my_robot_basics.session.pressure import Stopwatch

AWAY_SEC, MOST_SEC = 3.0, 4.5
"""How long the client may take to answer, in seconds of free time (`Stopwatch.free_sec`) and of
wall time. A callback that waits 2 s always passes, and one that waits 5 s always fails."""
FIRST_SEC, LOOK_SEC = 0.5, 0.1
"""After FIRST_SEC without an answer, the notebook is asked which line the callback is at; then
the check looks for the answer every LOOK_SEC."""
TIMES = 3
"""How many requests the client has to answer: it handles the message between two of them."""
ARRIVED_SEC = 2.0
"""How long to wait until DDS acknowledges the message."""


def publish_in_vain(server: ServedAction, message: Any) -> None:
    """Publish a message while there is no server, and expect that the client does not block.

    It has to answer parameter requests meanwhile, if it did before. Raises CheckFailed.
    """
    node = server.watcher.node
    clients = {
        name: node.create_client(GetParameters, f'{name}/get_parameters')
        for name in sorted(server.client.answering())
    }
    server.watcher.spin_until_free(
        lambda: all(client.service_is_ready() for client in clients.values()), free_sec=AWAY_SEC
    )
    server.publish(message)
    server.client.publishers[server.asked_on].wait_for_all_acked(Duration(seconds=ARRIVED_SEC))
    for _ in range(TIMES):
        for name, client in clients.items():
            _expect_answer(server, name, client)
    for client in clients.values():
        node.destroy_client(client)


def _expect_answer(server: ServedAction, name: str, client: Client) -> None:
    watch, asked = Stopwatch(), client.call_async(NOTHING)
    if server.watcher.spin_until(asked.done, timeout_sec=FIRST_SEC):
        return
    is_waiting = node_troubles.waits_in_callback(name)
    while watch.free_sec() < AWAY_SEC and watch.wall_sec() < MOST_SEC:
        if server.watcher.spin_until(asked.done, timeout_sec=LOOK_SEC):
            return
    fail(
        expected=f'a node that goes on with its work while there is no server of {server.name}',
        seen=f'no answer from it in {AWAY_SEC:g} s',
        hint='it waits inside a callback: look at server_is_ready(), which answers at once, and '
        'send no goal while there is no server',
        cause='the node waits for a server',
        doubt=CheckFailed if is_waiting else doubt_after(watch, AWAY_SEC),
    )
