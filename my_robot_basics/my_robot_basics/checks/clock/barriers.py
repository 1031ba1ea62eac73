"""Parameter requests to nodes: an answer shows that a node has handled what came before."""

import statistics
import time
from collections.abc import Callable, Iterable

from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.task import Future

from my_robot_basics.checks.clock.inconclusive import TooSlow
from my_robot_basics.graph.ignored_callback_group import IgnoredCallbackGroup
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

NOTHING = GetParameters.Request()
"""A request for no parameter: only the answer's arrival counts."""
PROMPT_SEC = 0.01
"""How long to wait for a message that is due, before a request is sent instead."""
SLOWEST_BARRIER_SEC = 0.5
"""How long `acknowledge` waits for answers, in seconds of free time."""
SLOWEST_MEDIAN_SEC = 0.02
"""How long answers may take in the median, in seconds of free time."""
MEDIAN_EVERY = 40
"""How many answers come between two looks at their median."""


class Barriers:
    """Clients of the parameter services of nodes, which measure how long the answers take."""

    def __init__(self, watcher: Watcher) -> None:
        """Start without a node; call `add` for each."""
        self._watcher = watcher
        self._clients: dict[str, Client] = {}
        self._unanswered: dict[str, Client] = {}
        self._took_sec: list[float] = []
        self._watch = Stopwatch()
        self._next_median = MEDIAN_EVERY

    def __len__(self) -> int:
        """How many nodes are asked."""
        return len(self._clients)

    def add(self, name: str) -> tuple[Client, Client]:
        """Make and return two clients of the node with that full name; nothing is asked yet."""
        node, service = self._watcher.node, f'{name}/get_parameters'
        self._clients[name] = node.create_client(GetParameters, service)
        self._unanswered[name] = node.create_client(
            GetParameters, service, callback_group=IgnoredCallbackGroup()
        )
        return self._clients[name], self._unanswered[name]

    def keep(self, names: Iterable[str]) -> None:
        """Ask only the nodes with these names from now on."""
        self._clients = {name: self._clients[name] for name in names}
        self._unanswered = {name: self._unanswered[name] for name in self._clients}

    def ask(self, names: Iterable[str] | None = None) -> dict[str, Future]:
        """Request `use_sim_time` of these nodes, or of all; return the futures by node name."""
        request = GetParameters.Request(names=['use_sim_time'])
        asked = self._clients if names is None else names
        return {name: self._clients[name].call_async(request) for name in asked}

    def wait_for(self, until: Callable[[], bool]) -> bool:
        """Whether `until()` is true within PROMPT_SEC, which replaces a single node's answer."""
        start = time.monotonic()
        is_true = len(self) == 1 and self._watcher.spin_until(until, timeout_sec=PROMPT_SEC)
        if is_true:
            self._took_sec.append(time.monotonic() - start)
        return is_true

    def acknowledge(self, questions: int) -> None:
        """Send each node so many requests, and wait for the last answers. Raises TooSlow.

        A node answers one after the other, so that its last answer shows that it answered all.
        """
        start = time.monotonic()
        for _ in range(questions - 1):
            for client in self._unanswered.values():
                # only the last answer is read: the others need no future
                with client.handle:
                    client.handle.send_request(NOTHING)
        asked = [client.call_async(NOTHING) for client in self._clients.values()]
        if not self._watcher.spin_until_free(
            lambda: all(future.done() for future in asked), free_sec=SLOWEST_BARRIER_SEC
        ):
            raise TooSlow('a node did not answer in time')
        self._took_sec.append(time.monotonic() - start)
        # the median of all answers: on a busy machine, each node is slow for a moment
        if len(self._took_sec) >= self._next_median:
            self._next_median = len(self._took_sec) + MEDIAN_EVERY
            if self._usual_sec() > SLOWEST_MEDIAN_SEC:
                raise TooSlow('a node answers too slowly')

    def _usual_sec(self) -> float:
        """The median of the answers' times, in seconds of free time."""
        free_share = self._watch.free_sec() / self._watch.wall_sec()
        return statistics.median(self._took_sec) * free_share
