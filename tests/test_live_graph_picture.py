"""The graph as a picture: the places of nodes and topics, and the same in words."""

import io
from collections import defaultdict
from itertools import pairwise

import pytest
from matplotlib.image import imread
from my_robot_basics.doctor.evidence import Endpoint
from my_robot_basics.live.pictures import graph_picture
from my_robot_basics.live.pictures.graph_picture import Box, arrows_of, describe, draw
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from my_robot_basics import live

STRING, INT = 'std_msgs/msg/String', 'std_msgs/msg/Int32'


def graph(text, nodes=()):
    """Arrows between nodes and topics, from lines like `/a > /t` or `/t > /a`."""
    ends = []
    for line in text.split(','):
        start, stop = line.split()[0], line.split()[-1]
        kind = 'publisher' if stop.startswith('/t') else 'subscription'
        node, topic = (start, stop) if kind == 'publisher' else (stop, start)
        name, _, type_name = topic.partition('@')
        ends.append(
            Endpoint(
                kind=kind,
                node_name=node,
                name=name,
                type_name=type_name or STRING,
                qos_profile=QoSProfile(depth=1),
            )
        )
    return arrows_of(nodes, ends)


def column(arrows, name):
    return {box.name: x for box, (x, _) in graph_picture._places(arrows).items()}[name]


PIPELINE = '/a > /t1, /t1 > /b, /b > /t2, /t2 > /c'


@pytest.mark.parametrize(
    ('text', 'columns'),
    [
        (PIPELINE, {'/a': 0, '/t1': 1, '/b': 2, '/t2': 3, '/c': 4}),
        ('/t1 > /b', {'/t1': 1, '/b': 2}),
        ('/a > /t1', {'/a': 0, '/t1': 1}),
        # a second sender stands near its topic
        (PIPELINE + ', /d > /t2', {'/d': 2, '/c': 4}),
        # a loop: the way back is an arrow from right to left
        (PIPELINE + ', /c > /t3, /t3 > /a', {'/a': 0, '/c': 4, '/t3': 5}),
        ('/a > /t1, /t1 > /a', {'/a': 0, '/t1': 1}),
    ],
)
def test_messages_go_from_left_to_right(text, columns):
    arrows = graph(text)
    assert {name: column(arrows, name) for name in columns} == columns


@pytest.mark.parametrize(
    'text',
    [
        PIPELINE,
        '/a > /t1, /b > /t1, /a > /t2, /c > /t3, /t3 > /d',
        '/a > /t1, /b > /t1, /t1 > /c, /t1 > /d, /t2 > /e, /t3 > /f, /g > /t4, /t4 > /h',
    ],
)
def test_boxes_of_one_column_are_a_row_apart(text):
    rows = defaultdict(list)
    for column, height in graph_picture._places(graph(text, nodes=['/alone', '/lone'])).values():
        rows[column].append(height)
    for heights in rows.values():
        gaps = [high - low for low, high in pairwise(sorted(heights))]
        assert min(gaps, default=1.0) > 0.999


def test_a_name_with_two_types_is_two_topics():
    arrows = graph(f'/a > /t, /b > /t@{INT}, /t > /c')
    assert arrows[Box('/a')] == (Box('/t', STRING),)
    assert arrows[Box('/t', STRING)] == (Box('/c'),)
    assert arrows[Box('/t', INT)] == ()


@pytest.mark.parametrize(
    ('arrows', 'text'),
    [
        ({}, 'graph: no node is running'),
        (
            graph('/a > /t, /b > /t, /t > /c'),
            'graph: /t (std_msgs/msg/String): /a and /b → /c',
        ),
        (graph('/a > /t', nodes=['/d']), f'graph: /t ({STRING}): /a → nobody; on no topic: /d'),
    ],
)
def test_the_description_says_what_the_picture_shows(arrows, text):
    assert describe(arrows) == text


@pytest.mark.parametrize('text', [PIPELINE, '/a > /t1, /t1 > /a'])
def test_the_same_graph_is_the_same_picture(text):
    arrows = graph(text, nodes=['/alone'])
    png = draw(arrows, title='now')
    assert png == draw(arrows, title='now')
    assert png != draw(arrows)
    height, width, _ = imread(io.BytesIO(png)).shape
    assert width > height


def test_an_empty_graph_has_a_picture():
    assert draw({}).startswith(b'\x89PNG')


@pytest.mark.slow
@pytest.mark.starts
def test_the_graph_shows_live_nodes_but_no_hidden_nodes_or_topics_of_ros(capsys):
    talker, listener, hidden = (live.run(Node, n, key=n) for n in ('talker', 'listener', '_own'))
    for node in talker, hidden:
        node.create_publisher(String, '/talk', 10)
    for node in listener, hidden:
        node.create_subscription(String, '/talk', print, 10)
    live.show_graph()
    assert capsys.readouterr().out == f'graph: /talk ({STRING}): /talker → /listener\n'
    live.stop()
    live.show_graph()
    assert capsys.readouterr().out == 'graph: no node is running\n'
