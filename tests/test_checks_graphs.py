"""The graph without the course's own nodes, and the reasons for silence it gives."""

import time
import types

import pytest
from my_robot_basics.checks import graph
from my_robot_basics.graph import graphs
from my_robot_basics.graph.snapshot import GraphSnapshot
from rclpy.node import Node
from std_msgs.msg import String

from my_robot_basics import live


@pytest.mark.starts
def test_the_graph_lists_every_endpoint_and_no_hidden_node():
    talker, listener, hidden = (live.run(Node, n, key=n) for n in ('talker', 'listener', '_own'))
    for node in (talker, talker, hidden):
        node.create_publisher(String, '/talk', 10)
    for node in (listener, hidden):
        node.create_subscription(String, '/talk', print, 10)
    seen = graph()
    live.stop()
    assert seen.nodes() == ('/listener', '/talker')
    assert seen.publishers('/talk') == ('/talker', '/talker')
    assert seen.subscriptions('/talk') == ('/listener',)
    assert seen.publishers('/nowhere') == ()
    assert graph().nodes() == ()


@pytest.mark.parametrize(
    ('nodes', 'was', 'ago_sec', 'is_waited_for'),
    [
        (('/a',), ('/a',), 0.5, False),
        (('/a',), ('/a',), 0.1, True),
        (('/a', '/b'), ('/a',), 0.5, True),
        (('/a', f'/{graphs.UNKNOWN}'), ('/a', f'/{graphs.UNKNOWN}'), 0.5, True),
    ],
)
def test_an_unchanged_graph_counts_as_settled(monkeypatch, nodes, was, ago_sec, is_waited_for):
    now, waited = picture(nodes, publishers={'/t': nodes}), []
    monkeypatch.setattr(graphs, '_read_graph', lambda node: now)
    earlier = time.monotonic() - ago_sec, picture(was, publishers={'/t': was})
    watcher = types.SimpleNamespace(node=None, earlier_look=earlier, spin_for=waited.append)
    assert graphs.take_snapshot(watcher) == now
    assert bool(waited) == is_waited_for


def picture(nodes=('/a',), publishers=None, subscriptions=None):
    return GraphSnapshot(nodes, publishers or {}, subscriptions or {})


@pytest.mark.parametrize(
    ('seen', 'why'),
    [
        (picture(nodes=()), 'the node is not running, so run the cell that starts it'),
        (picture(subscriptions={'/t/joint_states': ('/a',)}), '/a is at the other end of this'),
        (
            picture(
                nodes=('/a', '/b'),
                publishers={'/s/joint_states': ('/a', '/b')},
                subscriptions={'/t/joint_states': ('/a',)},
            ),
            '/a is at the other end of this topic, so check',
        ),
        (picture(), '/a runs, so look at the topic name in create_publisher'),
        (
            picture(nodes=('/a', '/b')),
            '/a, /b run, so if yours is among them, look',
        ),
        (picture(publishers={'/t/joint_states': ('/a',)}), '/a has a publisher there and sends'),
        (picture(publishers={'/t/joint_state': ('/a',)}), '/a uses /t/joint_state, so compare'),
        (picture(publishers={'/joint_states': ('/a',)}), '/a uses /joint_states, so compare'),
        (
            picture(publishers={'/n/t/joint_states': ('/n/a',)}, nodes=('/n/a',)),
            '/n/a uses /n/t/joint_states: a name without a leading / is relative to',
        ),
        (picture(publishers={'/n/t/joint_states': ('/a',)}), '/a uses /n/t/joint_states, so'),
        (
            picture(publishers={'/a/t/joint_states': ('/a',)}),
            "/a uses /a/t/joint_states: a name with ~ begins with its node's own name",
        ),
        (picture(publishers={'/rosout': ('/a',)}), '/a runs, so look at the topic name'),
        (picture(publishers={'/Joint_States': ('/a',)}), '/a uses /Joint_States, so compare'),
    ],
)
def test_silence_on_a_topic_is_explained(seen, why):
    assert seen.why_no_message('/t/joint_states').startswith(why)


@pytest.mark.starts
def test_a_missing_subscription_is_explained():
    seen = picture(subscriptions={'/target_points': ('/a',)})
    assert (
        seen.why_no_subscription('/target_point')
        == '/a uses /target_points, so compare the spelling'
    )
