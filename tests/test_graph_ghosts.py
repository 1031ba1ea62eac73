"""A name that stays on the graph though its node has ended, and how it differs from a node."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks.recordings import callbacks
from my_robot_basics.graph import actions, graphs, services
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from rclpy.action import ActionServer
from rclpy.context import Context
from rclpy.node import Node
from std_srvs.srv import Trigger

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK


@pytest.fixture
def node():
    """A node of another participant; the test destroys it."""
    context = Context()
    context.init(domain_id=classroom.enter())
    yield Node('speaker', context=context)
    context.try_shutdown()


@pytest.mark.starts
def test_a_name_on_the_graph_without_a_node_counts_as_gone(monkeypatch, node):
    names = graphs.node_names
    monkeypatch.setattr(graphs, 'node_names', lambda node: ['/ghost', *names(node)])
    with Watcher() as watcher:

        def comes(is_so):
            return watcher.spin_until(is_so, timeout_sec=30.0)

        assert graphs.is_gone(watcher, '/ghost')
        assert comes(lambda: not graphs.is_gone(watcher, '/speaker'))
        node.destroy_node()
        assert comes(lambda: graphs.is_gone(watcher, '/speaker'))


@pytest.fixture
def namesakes():
    """Two nodes of one name, in participants of their own."""
    contexts = [Context(), Context()]
    for context in contexts:
        context.init(domain_id=classroom.enter())
    nodes = [Node('namesake', context=context) for context in contexts]
    yield nodes
    for node, context in zip(nodes, contexts, strict=True):
        node.destroy_node()
        context.try_shutdown()


@pytest.mark.starts
def test_services_and_actions_of_two_nodes_with_one_name_are_all_found(namesakes):
    """If two nodes have one name, rmw lists the services of only one of them.

    The other one may have ended and still be on the graph.
    """
    first, second = namesakes
    made = [first.create_service(SolveIK, '/solve_ik', lambda request, response: response)]
    made += [first.create_client(Trigger, '/ask')]
    made += [second.create_service(Trigger, '/tell', lambda request, response: response)]
    made += [ActionServer(second, MoveArm, '/move_arm', lambda handle: MoveArm.Result())]
    with Watcher() as watcher:

        def ends():
            found, moves = services.take_graph(watcher.node), actions.take_graph(watcher.node)
            own = {name: each for name, each in found.servers.items() if '/_' not in name}
            return own, found.clients, moves.servers

        wanted = (
            {
                '/solve_ik': {'/namesake': ('arm_interfaces/srv/SolveIK',)},
                '/tell': {'/namesake': ('std_srvs/srv/Trigger',)},
            },
            {'/ask': {'/namesake': ('std_srvs/srv/Trigger',)}},
            {'/move_arm': {'/namesake': ('arm_interfaces/action/MoveArm',)}},
        )
        watcher.spin_until(lambda: ends() == wanted, timeout_sec=30.0)
        assert ends() == wanted
    for each in made:
        each.destroy()


@pytest.mark.parametrize(
    ('dds_type', 'type_'),
    [
        ('arm_interfaces::srv::dds_::SolveIK_Request_', 'arm_interfaces/srv/SolveIK'),
        (
            'arm_interfaces::action::dds_::MoveArm_SendGoal_Request_',
            'arm_interfaces/action/MoveArm',
        ),
        *[(each, each) for each in ('', 'word', 'dds_::Word_', '::')],
    ],
)
def test_a_type_that_is_none_of_ros_keeps_its_dds_name(monkeypatch, dds_type, type_):
    """Any text may be the type of a reader of requests."""
    info = SimpleNamespace(node_name='a', node_namespace='/', topic_type=dds_type)
    monkeypatch.setattr(services, 'subscription_infos', lambda node, name, is_dds: [info])
    monkeypatch.setattr(services, 'publisher_infos', lambda node, name, is_dds: [])
    node = SimpleNamespace(get_node_names_and_namespaces=lambda: [])
    found = services.take_servers_and_clients(node, {'/solve_ik': '/solve_ik'})
    assert found.servers == {'/solve_ik': {'/a': (type_,)}}


@pytest.mark.parametrize(
    ('names', 'publishers', 'is_gone'),
    [(['/a'], ['/a'], False), (['/a'], ['/b'], True), (['/b'], ['/a'], True), ([], [], True)],
    ids=['a node', 'a name alone', 'a publisher alone', 'neither'],
)
def test_a_node_is_gone_unless_it_has_a_name_and_a_publisher(
    monkeypatch, names, publishers, is_gone
):
    monkeypatch.setattr(graphs, 'node_names', lambda node: names)
    monkeypatch.setattr(graphs, 'publisher_infos', lambda node, topic_name: publishers)
    monkeypatch.setattr(graphs, 'full_name', lambda info: info)
    assert graphs.is_gone(SimpleNamespace(node=None), '/a') == is_gone


@pytest.mark.parametrize(('living', 'why'), [(['/a'], ''), ([], callbacks.ENDED)])
def test_a_node_whose_name_stays_without_a_publisher_is_reported_as_ended(
    monkeypatch, living, why
):
    """On a busy machine, the name of a node that had destroyed itself stayed on the graph."""
    monkeypatch.setattr(graphs, 'node_names', lambda node: ['/a'])
    monkeypatch.setattr(graphs, 'publisher_infos', lambda node, topic_name: living)
    monkeypatch.setattr(graphs, 'full_name', lambda info: info)
    watcher = SimpleNamespace(node=None, spin_until_free=lambda done, free_sec: done())
    assert callbacks.CallbackErrors(['/a']).why(watcher) == why
