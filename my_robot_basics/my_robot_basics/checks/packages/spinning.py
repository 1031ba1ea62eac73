"""Wait until the nodes of a program spin."""

from collections.abc import Sequence

from rcl_interfaces.srv import GetParameters

from my_robot_basics.graph.watcher import Watcher

SPIN_SEC = 2.0
"""How long to wait for a node's parameter services and their answer, each in s of free time."""


def wait_until_they_spin(watcher: Watcher, node_names: Sequence[str]) -> None:
    """Wait until the nodes' parameter services answer: then main has reached spin.

    A SIGINT before that would interrupt rclpy's initialization, which is not the student's fault.
    For a node without these services, or a busy one, the wait ends after SPIN_SEC each.
    """
    for name in node_names:
        client = watcher.node.create_client(GetParameters, f'{name}/get_parameters')
        if watcher.spin_until_free(client.service_is_ready, free_sec=SPIN_SEC):
            answer = client.call_async(GetParameters.Request())
            watcher.spin_until_free(answer.done, free_sec=SPIN_SEC)
