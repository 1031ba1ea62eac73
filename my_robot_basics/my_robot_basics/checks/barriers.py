"""Questions to nodes that are answered when they have dealt with what came before them."""

import statistics
import time
from collections.abc import Callable, Iterable

from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.task import Future

from my_robot_basics.checks.inconclusive import TooSlow
from my_robot_basics.graph.unheeded import Unheeded
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

NOTHING = GetParameters.Request()
"""A question about no parameter: the answer is all that counts."""
PROMPT_SEC = 0.01
"""How long a message may take that is due: then a question is asked."""
SLOWEST_BARRIER_SEC = 0.5
SLOWEST_MEDIAN_SEC = 0.02
MEDIAN_EVERY = 40


class Barriers:
    """The parameter services of some nodes, and how long they take to answer."""

    def __init__(self, watcher: Watcher) -> None:
        """No node is asked yet."""
        self._watcher = watcher
        self._clients: dict[str, Client] = {}
        self._unheeded: dict[str, Client] = {}
        self._took_sec: list[float] = []
        self._watch = Stopwatch()
        self._next_median = MEDIAN_EVERY

    def __len__(self) -> int:
        """How many nodes there are."""
        return len(self._clients)

    def add(self, name: str) -> tuple[Client, Client]:
        """Prepare to ask the node of that full name, by two clients."""
        node, service = self._watcher.node, f'{name}/get_parameters'
        self._clients[name] = node.create_client(GetParameters, service)
        self._unheeded[name] = node.create_client(
            GetParameters, service, callback_group=Unheeded()
        )
        return self._clients[name], self._unheeded[name]

    def keep(self, names: Iterable[str]) -> None:
        """Ask only these from now on."""
        self._clients = {name: self._clients[name] for name in names}
        self._unheeded = {name: self._unheeded[name] for name in self._clients}

    def ask(self, names: Iterable[str] | None = None) -> dict[str, Future]:
        """Ask each node, or these, for its `use_sim_time`; the futures by the nodes' names."""
        request = GetParameters.Request(names=['use_sim_time'])
        asked = self._clients if names is None else names
        return {name: self._clients[name].call_async(request) for name in asked}

    def wait_for(self, until: Callable[[], bool]) -> bool:
        """Whether `until()` is true soon, which tells of a sole node what an answer would."""
        start = time.monotonic()
        is_true = len(self) == 1 and self._watcher.spin_until(until, timeout_sec=PROMPT_SEC)
        if is_true:
            self._took_sec.append(time.monotonic() - start)
        return is_true

    def acknowledge(self, questions: int) -> None:
        """Wait until every node has answered so many questions. Raises TooSlow.

        They are answered one after the other, so that the last answer tells of all.
        """
        start = time.monotonic()
        for _ in range(questions - 1):
            for client in self._unheeded.values():
                # no future is made for an answer that nobody takes
                with client.handle:
                    client.handle.send_request(NOTHING)
        asked = [client.call_async(NOTHING) for client in self._clients.values()]
        if not self._watcher.spin_until_free(
            lambda: all(future.done() for future in asked), free_sec=SLOWEST_BARRIER_SEC
        ):
            raise TooSlow('a node did not answer in time')
        self._took_sec.append(time.monotonic() - start)
        # over all of them: on a busy machine everybody is slow for a moment
        if len(self._took_sec) >= self._next_median:
            self._next_median = len(self._took_sec) + MEDIAN_EVERY
            if self._usual_sec() > SLOWEST_MEDIAN_SEC:
                raise TooSlow('a node answers too slowly')

    def _usual_sec(self) -> float:
        """What a node usually takes to answer, of time that was free."""
        free_share = self._watch.free_sec() / self._watch.wall_sec()
        return statistics.median(self._took_sec) * free_share
