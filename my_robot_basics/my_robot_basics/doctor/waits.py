"""What a callback waits for, and whether the callback itself prevents it."""

import inspect
from collections.abc import Callable, Iterable
from types import FrameType
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

from my_robot_basics.doctor.callback import Keeps
from my_robot_basics.doctor.work import Work, own_nodes

CALL, AWAIT, SERVER = 'call', 'await', 'wait_for_service'
SPIN = 'spin_until_future_complete'
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    CALL: Client.call,
    SERVER: Client.wait_for_service,
    SPIN: Executor.spin_until_future_complete,
    AWAIT: Future.__await__,
}
_CODES = {inspect.unwrap(function).__code__: name for name, function in _FUNCTIONS.items()}


def current_wait(frames: Iterable[FrameType]) -> tuple[str, Client | None]:
    """Return the rclpy function in which a callback waits, and the client of the response."""
    for frame in frames:
        name = _CODES.get(frame.f_code, '')
        if name in (CALL, SERVER):
            return name, frame.f_locals['self']
        if name:
            return name, _asked_by(frame.f_locals['future' if name == SPIN else 'self'])
    return '', None


def response_blocker(work: Work, others: Iterable[Work]) -> Keeps:
    """Return what blocks the response that a callback waits for, or ''.

    To take the response, the executor that spins the client's node needs a free thread, and no
    other callback of the client's mutually exclusive group may be in progress.
    """
    name, client = current_wait(work.frames)
    if client is None or name == SERVER:
        return ''
    node = node_of(client)
    if node is None:
        return ''
    if name == CALL and node.executor is work.executor:
        if type(work.executor) is SingleThreadedExecutor:
            return 'executor'
        if type(work.executor) is MultiThreadedExecutor and _fills(work.executor, others):
            return 'threads'
    group = client.callback_group
    if (
        work.entity is not None
        and isinstance(group, MutuallyExclusiveCallbackGroup)
        and group._active_entity is work.entity
    ):
        return 'group'
    return ''


def blocked_nodes(work: Work) -> Iterable[Node]:
    """Yield the nodes that answer no parameter request while the callback is in progress."""
    own = {*own_nodes()}
    if work.is_running and type(work.executor) is SingleThreadedExecutor:
        yield from own & {*work.executor.get_nodes()}
    group = getattr(work.entity, 'callback_group', None)
    default = getattr(work.node, 'default_callback_group', None)
    if work.node in own and group is default and isinstance(group, MutuallyExclusiveCallbackGroup):
        yield work.node


def pending_service(work: Work) -> str:
    """Return a service with a response that can't be taken before the callback returns, or ''."""
    if not work.is_running or type(work.executor) is not SingleThreadedExecutor:
        return ''
    nodes = {*own_nodes()} & {*work.executor.get_nodes()}
    clients = [client for node in nodes for client in node.clients]
    return next((client.service_name for client in clients if pending_requests(client)), '')


def pending_requests(client: Client) -> dict[int, Future]:
    """Return a client's requests without a response, by their sequence numbers."""
    # a finished one stays in rclpy's dict until the executor spins again
    requests = client._pending_requests.copy().items()
    return {number: future for number, future in requests if not future.done()}


def _fills(executor: MultiThreadedExecutor, works: Iterable[Work]) -> bool:
    """Whether blocking calls whose responses this executor must take occupy all its threads."""
    clients = [current_wait(w.frames) for w in works if w.is_running and w.executor is executor]
    blocked = [
        client
        for name, client in clients
        if name == CALL and client and getattr(node_of(client), 'executor', None) is executor
    ]
    return len(blocked) >= executor._executor._max_workers


def _asked_by(future: Future) -> Client | None:
    """Return the client of this process whose pending response is this future."""
    return next(
        (
            client
            for node in own_nodes()
            for client in node.clients
            if any(future is each for each in pending_requests(client).values())
        ),
        None,
    )


def node_of(client: Client) -> Node | None:
    """Return the node of this process that created the client."""
    return next((node for node in own_nodes() if client in node.clients), None)
