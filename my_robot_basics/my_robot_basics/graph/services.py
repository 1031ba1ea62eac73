"""Services on the graph: which nodes are servers or clients of each service, and of which type."""

from collections.abc import Mapping
from dataclasses import dataclass

from rclpy.node import Node

from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.graphs import (
    UNKNOWN,
    full_name,
    publisher_infos,
    subscription_infos,
)
from my_robot_basics.graph.not_running import why_not_running
from my_robot_basics.graph.snapshot import similar
from my_robot_basics.graph.watcher import HIDDEN

OF_EVERY_NODE = frozenset(
    """describe_parameters get_parameter_types get_parameters list_parameters set_parameters
    set_parameters_atomically get_type_description""".split()  # noqa: SIM905
)
"""The last parts of the names of the services that rclpy creates in every node."""


@dataclass(frozen=True)
class ServiceGraph:
    """Servers and clients of services or actions, without nodes whose names start with `_`."""

    node_names: tuple[str, ...]
    """Full names of all nodes, sorted."""
    servers: dict[str, dict[str, tuple[str, ...]]]
    """Service name to full name of the server's node to the types of its servers."""
    clients: dict[str, dict[str, tuple[str, ...]]]
    """The same for clients."""
    node: Node
    """The node that took this graph; `why_none` also looks up topics with it."""

    def why_none(self, name: str, *, maker: str) -> str:
        """What to try if a service or action has no server, or no client: one clause.

        `maker` creates what is missing: 'create_service', 'create_client', 'ActionServer' or
        'ActionClient'.
        """
        is_served = maker in ('create_service', 'ActionServer')
        ends = self.servers if is_served else self.clients
        kind = 'action' if maker.startswith('Action') else 'service'
        if not self.node_names:
            return why_not_running()
        find, mistaken_maker = publisher_infos, 'create_publisher'
        if is_served:
            find, mistaken_maker = subscription_infos, 'create_subscription'
        if mistaken := sorted({full_name(info) for info in find(self.node, name)}):
            return (
                f'{student_text(", ".join(mistaken))} has a topic of this name, and no {kind}: '
                f'call {maker}(…) in place of {mistaken_maker}(…)'
            )
        if near := similar(name, [each for each in ends if each != name]):
            uses = student_text(f'{", ".join(ends[near])} uses {near}')
            if any(near == f'{node.rpartition("/")[0]}{name}' for node in ends[near]):
                return f"{uses}: a name without a leading / is relative to its node's namespace"
            return f'{uses}, so compare the spelling'
        runs = student_text(', '.join(self.node_names))
        return f'{runs} runs, so look at the {kind} name in {maker}(…) and that the node calls it'


def take_graph(node: Node) -> ServiceGraph:
    """The services as a node sees them now."""
    names = [name for name, _ in node.get_service_names_and_types()]
    own = [name for name in names if name.rpartition('/')[2] not in OF_EVERY_NODE]
    return take_servers_and_clients(node, {name: name for name in own})


def take_servers_and_clients(node: Node, requests: Mapping[str, str]) -> ServiceGraph:
    """The servers and clients of `requests`: names of services or actions to request services.

    A service is its own request service; that of an action is send_goal. The DDS endpoints of the
    requests are looked up, not the services of each node name: an ended node without services may
    stay on the graph under the name of a running one, and would hide its services.
    """
    servers: dict[str, dict[str, tuple[str, ...]]] = {}
    clients: dict[str, dict[str, tuple[str, ...]]] = {}
    for name, asks in requests.items():
        for ends, find in ((servers, subscription_infos), (clients, publisher_infos)):
            for info in find(node, f'rq{asks}Request', is_dds=True):
                if info.node_name != UNKNOWN:
                    types = ends.setdefault(name, {})
                    whose, type_ = full_name(info), _type_of(info.topic_type)
                    types[whose] = tuple(sorted({*types.get(whose, ()), type_}))
    names = {
        f'{namespace.rstrip("/")}/{name}'
        for name, namespace in node.get_node_names_and_namespaces()
        if not name.startswith(HIDDEN)
    }
    return ServiceGraph(tuple(sorted(names)), servers, clients, node)


def _type_of(dds_type: str) -> str:
    """ROS's name of a service or action type, from the DDS type of its requests."""
    parts = dds_type.split('::')
    if len(parts) < 3:
        return dds_type  # not made by ROS
    package, kind, *_, name = parts
    return f'{package}/{kind}/{name.removesuffix("_Request_").removesuffix("_SendGoal")}'
