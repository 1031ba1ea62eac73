"""A check's client of a service: it calls the server, and explains why no response comes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from rcl_interfaces.srv import GetParameters
from rclpy.qos import QoSProfile
from rclpy.task import Future

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.recordings.sleeping_callbacks import or_sleeps
from my_robot_basics.checks.services.awaited_servers import (
    SERVER_SEC,
    expect_type,
    wait_for_server,
)
from my_robot_basics.checks.services.late_answers import WAITED_SEC
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import expect, fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import earlier_waits, graphs, services
from my_robot_basics.graph.watcher import Watcher

ANSWER_SEC = 4.0
"""How long to wait for a response, in s of free time, from the one before: a server that takes its
time answers one request after the other."""
Why = Callable[[], str]
LOOK_SEC = 0.5
"""How often to ask the notebook meanwhile whether a callback has raised."""
PARAMETERS_SEC, LATE_SEC = 1.0, 0.25
"""How long a spinning node may take to answer for a parameter, in s of free time; after how long
this is late, in s of wall time. The notebook then needs half a second to tell that a callback
sleeps: a sleep of 1 s is always found, and one of 0.5 s never."""
RESPONSES = QoSProfile(depth=1000)
"""The queue for responses is long: a wrong server's additional responses must not push any out."""


def service(name: str, type_: type) -> 'Service':
    """The service of that absolute name and type.

    `response = service('/solve_ik', SolveIK).call(SolveIK.Request(target=point))`
    """
    return Service(name, type_)


@dataclass(frozen=True)
class Service:
    """A service of the student's node; each call makes a client for itself."""

    name: str
    """The absolute name, such as '/solve_ik'."""
    type: type
    """The service's class, such as `arm_interfaces.srv.SolveIK`."""

    def call(self, request: Any, *, what: str = '') -> Any:
        """Send a request; return the response. Raises CheckFailed as `call_all` does."""
        return self.call_all(request, what=what)[0]

    def call_all(self, *requests: Any, what: str = '') -> list[Any]:
        """Send all requests at once, before any is answered; return their responses in order.

        `what` is in them, for the reason if there is no answer: all that students read of a
        request of a hidden part.
        The server may answer in any order. Raises CheckFailed if there is no server, one of
        another type, or more than one; also if a response does not come in ANSWER_SEC of free
        time, with the reason: the callback raised, returned no response, does not return, or the
        node does not spin.
        """
        with Watcher(shared=True) as watcher:
            server = self._meet(watcher)
            raised = CallbackErrors([server])
            client = watcher.node.create_client(self.type, self.name, qos_profile=RESPONSES)
            watcher.spin_until(client.service_is_ready, timeout_sec=SERVER_SEC)
            asked = [client.call_async(request) for request in requests]
            if not wait_for_all(watcher, asked, gives_up=raised.hint, names=[server]):
                self._fail_unanswered(watcher, server, raised, asked, what)
            raised.expect_none()
            return [future.result() for future in asked]

    def _meet(self, watcher: Watcher) -> str:
        """Wait for the server; return the full name of its node. Raises CheckFailed."""
        found: dict[str, tuple[str, ...]] = {}

        def is_there() -> bool:
            found.clear()
            found.update(services.take_graph(watcher.node).servers.get(self.name, {}))
            return bool(found)

        if none := wait_for_server(watcher, self.name, is_there):
            fail(
                expected=f'a server of {self.name}',
                seen=none.seen,
                hint=services.take_graph(watcher.node).why_none(self.name, maker='create_service'),
                doubt=none.doubt,
            )
        expect_type(self.name, self.type, found, maker='create_service')
        known = ('service', self.name), {**found}
        if not earlier_waits.is_known(watcher.context, *known):
            watcher.spin_for(graphs.NEWCOMER_SEC)
        # count servers, not names: two nodes may have the same name
        count = watcher.node.count_services(self.name)
        expect(
            count == 1,
            expected=f'one server of {self.name}',
            seen=f'{count} ({student_text(", ".join(sorted(found)))})',
            hint='stop the other node: nobody knows whose answer arrives'
            if len(found) > 1
            else 'call create_service once, in __init__, and start the node once',
            cause=f'{self.name} has more than one server',
        )
        earlier_waits.remember(watcher.context, *known)
        return next(iter(found))

    def _fail_unanswered(
        self,
        watcher: Watcher,
        server: str,
        raised: CallbackErrors,
        futures: Sequence[Future],
        what: str,
    ) -> NoReturn:
        answered, asked = sum(future.done() for future in futures), len(futures)
        seen = f'{answered} of {asked}' if answered else 'none'
        if not raised.hint():
            late = f'{answered} of {asked} in {ANSWER_SEC:g} s'
            seen = late if answered else f'none in {ANSWER_SEC:g} s'
        fail(
            expected='an answer to each request' if asked > 1 else 'an answer',
            seen=seen,
            hint=self._why_unanswered(watcher, server, raised),
            cause=f'{self.name} does not answer {what}'
            if what
            else f'{self.name} does not answer',
        )

    def _why_unanswered(self, watcher: Watcher, server: str, raised: CallbackErrors) -> str:
        if raised.hint():
            # rclpy raises a TypeError without a message if a callback returns no response
            if node_troubles.last_raised(server) == 'TypeError':
                return 'end the callback with `return response`, in each of its branches'
            return raised.hint()
        if why := raised.hint_or_thread():
            return why
        if line := node_troubles.blocking_line(server):
            return (
                f'its callback has not returned ({student_text(line)}), so see what it waits for: '
                'no answer is delivered to its node while it waits'
            )
        if not answers_parameters(watcher, server):
            return (
                f'{student_text(server)} answers nothing at all, so see that it spins, and that '
                'its callback ends with `return response`, raises nothing, and waits for nothing'
            )
        return (
            f'{student_text(server)} runs, and the callback of this service has not returned: see '
            'what it waits for'
        )


def wait_for_all(
    watcher: Watcher, asked: Sequence[Future], *, gives_up: Why, names: Sequence[str] = ()
) -> bool:
    """Spin until all are answered, at most ANSWER_SEC of free time for each; return whether so.

    `gives_up()` says why no response can come, or ''; if a callback of `names`, full names of
    nodes, sleeps, WAITED_SEC of wall time is the limit.
    """

    def are_done() -> bool:
        return all(future.done() for future in asked)

    answered = looks = 0
    is_over = or_sleeps(are_done, WAITED_SEC, lambda: names)
    while looks < round(ANSWER_SEC / LOOK_SEC):
        if watcher.spin_until_free(is_over, free_sec=LOOK_SEC) or gives_up():
            break
        before, answered, looks = answered, sum(future.done() for future in asked), looks + 1
        if answered > before:
            looks, is_over = 0, or_sleeps(are_done, WAITED_SEC, lambda: names)
    return are_done()


def answers_parameters(
    watcher: Watcher, node_name: str, *, when_late: Callable[[], None] | None = None
) -> bool:
    """Whether a node's parameter service answers: if so, the node spins and is not blocked.

    `when_late()` is called once if there is no answer within LATE_SEC.
    """
    client = watcher.node.create_client(GetParameters, f'{node_name}/get_parameters')
    told = watcher.spin_until_free(client.service_is_ready, free_sec=PARAMETERS_SEC)
    if told:
        asked = client.call_async(GetParameters.Request(names=['use_sim_time']))
        if when_late and not watcher.spin_until(asked.done, timeout_sec=LATE_SEC):
            when_late()
        told = watcher.spin_until_free(asked.done, free_sec=PARAMETERS_SEC)
    watcher.node.destroy_client(client)
    return told
