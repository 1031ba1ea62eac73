"""The nodes of this process are found, and the search disturbs nothing else."""

import subprocess
import sys
import threading
import time

import pytest
import rclpy
from my_robot_basics.session import classroom
from my_robot_basics.session.neighbours import Neighbours, nodes_here
from rclpy.context import Context
from rclpy.node import Node


class Derived(Node):
    """A node as students write them."""


def test_nodes_of_the_process_are_found_before_and_after_a_shutdown():
    context = Context()
    rclpy.init(args=[], context=context)
    made = {Node('plain', context=context), Derived('derived', context=context)}
    assert made <= set(nodes_here())
    context.shutdown()
    assert made <= set(nodes_here(alive=False))
    assert not made & set(nodes_here())
    for node in made:
        node.destroy_node()
    assert not made & set(nodes_here(alive=False))


@pytest.mark.slow
def test_the_search_for_nodes_does_not_disturb_a_thread_that_builds_tuples():
    errors = []
    looked = threading.Event()

    def build():
        while not looked.is_set():
            try:
                tuple(number for number in range(50))
            except SystemError as error:
                errors.append(error)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    builder = threading.Thread(target=build)
    builder.start()
    try:
        for _ in range(30):
            list(nodes_here())
    finally:
        looked.set()
        builder.join()
        sys.setswitchinterval(interval)
    assert errors == []


TALKER = """
import time, rclpy
rclpy.init()
node = rclpy.create_node('talker')
time.sleep(60)
"""


@pytest.mark.starts
def test_a_killed_node_is_not_a_neighbour():
    """It does not announce its end, and stays on the graph until its lease expires."""
    neighbours = Neighbours()
    neighbours.start()
    try:
        with subprocess.Popen([sys.executable, '-c', TALKER]) as process:
            while not neighbours._is_announced('/talker'):
                assert process.poll() is None
                time.sleep(0.01)
            process.kill()
        assert not neighbours.has_node('/talker')
    finally:
        neighbours.stop()


@pytest.mark.starts
def test_a_node_name_left_on_the_graph_without_a_node_is_not_a_neighbour(monkeypatch):
    """This happens if the last message of a participant is handled after its end: once, 7 tests of
    `run` failed because a node of another process, long gone, was reported to run.
    """
    names = Node.get_node_names_and_namespaces
    monkeypatch.setattr(
        Node, 'get_node_names_and_namespaces', lambda self: [*names(self), ('ghost', '/')]
    )
    context = Context()
    context.init(domain_id=classroom.enter())
    node = Node('talker', context=context, start_parameter_services=False)
    neighbours = Neighbours()
    neighbours.start()
    try:
        while not neighbours._is_announced('/talker'):
            time.sleep(0.01)
        assert not neighbours.has_node('/ghost')
    finally:
        neighbours.stop()
        node.destroy_node()
        context.try_shutdown()
