"""Whether nodes of a program spin by now."""

from collections.abc import Sequence

from rcl_interfaces.srv import GetParameters

from my_robot_basics.graph.watcher import Watcher

SPIN_SEC = 2.0
"""How long a node may take to answer for its parameters before it is told to end."""


def wait_until_they_spin(watcher: Watcher, node_names: Sequence[str]) -> None:
    """Wait until nodes answer for their parameters: before that, main is not in spin yet.

    SIGINT between would meet rclpy half set up, which is no mistake of the student's. A node
    without these services, or one that is busy, is not waited for long.
    """
    for name in node_names:
        client = watcher.node.create_client(GetParameters, f'{name}/get_parameters')
        if watcher.spin_until_free(client.service_is_ready, free_sec=SPIN_SEC):
            answer = client.call_async(GetParameters.Request())
            watcher.spin_until_free(answer.done, free_sec=SPIN_SEC)
