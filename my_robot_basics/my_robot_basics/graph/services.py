"""Services on the graph: which nodes serve one, which ask, and with which type."""

from collections.abc import Callable
from dataclasses import dataclass

from rclpy.node import Node

from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph.graphs import full_name, publisher_infos, subscription_infos
from my_robot_basics.graph.snapshot import NOT_RUNNING, similar
from my_robot_basics.graph.watcher import HIDDEN

OF_EVERY_NODE = frozenset(
    """describe_parameters get_parameter_types get_parameters list_parameters set_parameters
    set_parameters_atomically get_type_description""".split()  # noqa: SIM905
)
"""The services that every node has, by the last part of their names."""
LookUp = Callable[[str, str], list[tuple[str, list[str]]]]
"""What a node of that name and namespace has at one end: names, each with its types."""


@dataclass(frozen=True)
class ServiceGraph:
    """Who serves and who asks, without the nodes whose names start with `_`; of actions, too."""

    node_names: tuple[str, ...]
    """Full names of all nodes, sorted."""
    servers: dict[str, dict[str, tuple[str, ...]]]
    """Service name to full node name to the types that the node serves it with."""
    clients: dict[str, dict[str, tuple[str, ...]]]
    """The same of those that ask."""
    node: Node
    """The node that has seen them, to be asked about a topic of that name."""

    def why_none(self, name: str, *, maker: str) -> str:
        """What to try where nobody is at that end of a service: one clause.

        `maker` is 'create_service' or 'create_client', 'ActionServer' or 'ActionClient'.
        """
        is_served = maker in ('create_service', 'ActionServer')
        ends = self.servers if is_served else self.clients
        kind = 'action' if maker.startswith('Action') else 'service'
        if not self.node_names:
            return NOT_RUNNING
        find, mistaken_maker = publisher_infos, 'create_publisher'
        if is_served:
            find, mistaken_maker = subscription_infos, 'create_subscription'
        if mistaken := sorted({full_name(info) for info in find(self.node, name)}):
            return (
                f'{theirs(", ".join(mistaken))} has a topic of this name, and no {kind}: '
                f'call {maker}(…) in place of {mistaken_maker}(…)'
            )
        if near := similar(name, [each for each in ends if each != name]):
            uses = theirs(f'{", ".join(ends[near])} uses {near}')
            if any(near == f'{node.rpartition("/")[0]}{name}' for node in ends[near]):
                return f"{uses}: a name without a leading / is relative to its node's namespace"
            return f'{uses}, so compare the spelling'
        runs = theirs(', '.join(self.node_names))
        return f'{runs} runs, so look at the {kind} name in {maker}(…) and that the node calls it'


def take(node: Node) -> ServiceGraph:
    """The services as a node sees them now."""
    ends = node.get_service_names_and_types_by_node, node.get_client_names_and_types_by_node
    return take_ends(node, *ends)


def take_ends(node: Node, look_up_servers: LookUp, look_up_clients: LookUp) -> ServiceGraph:
    """What these find for each node that a node sees now."""
    nodes = [
        (name, namespace)
        for name, namespace in node.get_node_names_and_namespaces()
        if not name.startswith(HIDDEN)
    ]
    servers: dict[str, dict[str, tuple[str, ...]]] = {}
    clients: dict[str, dict[str, tuple[str, ...]]] = {}
    for name, namespace in nodes:
        full_name = f'{namespace.rstrip("/")}/{name}'
        for ends, look_up in ((servers, look_up_servers), (clients, look_up_clients)):
            try:
                found = look_up(name, namespace)
            except RuntimeError:  # it has gone meanwhile
                continue
            for service_name, types in found:
                if service_name.rpartition('/')[2] not in OF_EVERY_NODE:
                    ends.setdefault(service_name, {})[full_name] = tuple(types)
    names = tuple(sorted({f'{namespace.rstrip("/")}/{name}' for name, namespace in nodes}))
    return ServiceGraph(names, servers, clients, node)
