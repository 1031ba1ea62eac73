"""Why a node does not ask a service, or makes nothing of the answer: one clause each."""

from collections.abc import Callable

from my_robot_basics.checks.services import type_name
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher


def waits_for_answer(name: str) -> str:
    """The node has asked, and nothing else of it runs until it has the answer."""
    return (
        f"it called `{name}` inside a callback and waited there: the answer can't be delivered "
        'while the callback runs, or while all threads of its executor wait like this; use '
        'call_async and add_done_callback'
    )


def waits_for_server(name: str) -> str:
    """The node has not asked, and nothing of it runs."""
    return (
        f'it waits inside a callback, for `{name}` to be there or for the answer to an earlier '
        'request, and no other callback runs meanwhile; look at service_is_ready(), which returns '
        'at once, and ask with call_async and add_done_callback'
    )


def why_not_asked(
    watcher: Watcher, name: str, type_: type, *, asked_on: str, goes_on: Callable[[], bool]
) -> str:
    """What to try where no request comes. `goes_on` tells whether the node is alive."""
    ends = services.take(watcher.node)
    clients = ends.clients.get(name, {})
    types = {each for found in clients.values() for each in found}
    if not clients:
        return ends.why_none(name, maker='create_client')
    if type_name(type_) not in types:
        asks_for = theirs(' and '.join(sorted(types)))
        return f'it asks for {asks_for}, so compare the type in create_client(…)'
    if not goes_on():
        return waits_for_server(name)
    return f'call self.client.call_async(request) for each message on {asked_on}'


def why_not_published(name: str, *, goes_on: Callable[[], bool]) -> str:
    """What to try where an answer was sent, and nothing is made of it."""
    if not goes_on():
        return waits_for_answer(name)
    return (
        'publish when the answer is there, in the function that add_done_callback calls (call and '
        'spin_until_future_complete get no answer inside a callback)'
    )
