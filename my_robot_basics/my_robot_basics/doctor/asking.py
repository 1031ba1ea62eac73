"""Sends nodes a parameter request, which every node that is spun answers."""

from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.task import Future

from my_robot_basics.doctor.evidence import NodeState
from my_robot_basics.graph.watcher import Watcher

READY_SEC = 1.0
ANSWER_SEC = 3.0
"""How long to wait for answers, from the call of `answers`."""


class Questions:
    """A request to each node for its use_sim_time: sent at once, answered in the background."""

    UNASKED = NodeState(answers=None)

    def __init__(self, watcher: Watcher, node_names: list[str]) -> None:
        """Send the request to those of these nodes (full names) that have parameter services."""
        self._watcher = watcher
        services = dict(watcher.node.get_service_names_and_types())
        clients: dict[str, Client] = {
            name: watcher.node.create_client(GetParameters, f'{name}/get_parameters')
            for name in node_names
            if f'{name}/get_parameters' in services
        }
        watcher.spin_until(
            lambda: all(client.service_is_ready() for client in clients.values()),
            timeout_sec=READY_SEC,
        )
        self._asked: dict[str, Future] = {
            name: client.call_async(GetParameters.Request(names=['use_sim_time']))
            for name, client in clients.items()
            if client.service_is_ready()
        }

    def unanswered(self) -> set[str]:
        """Return the nodes that have got the request and have not answered yet."""
        return {name for name, future in self._asked.items() if not future.done()}

    def answers(self, *, timeout_sec: float = ANSWER_SEC) -> dict[str, NodeState]:
        """Wait for answers, at most `timeout_sec`; return the state of each of these nodes."""
        self._watcher.spin_until(lambda: not self.unanswered(), timeout_sec=timeout_sec)
        return {name: _state(future) for name, future in self._asked.items()}


def _state(future: Future) -> NodeState:
    if not future.done():
        return NodeState(answers=False)
    values = future.result().values
    return NodeState(answers=True, use_sim_time=any(value.bool_value for value in values))
