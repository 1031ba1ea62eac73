"""A node has the name that its exercise asks for."""

import pytest
from my_robot_basics.checks import CheckFailed, expect_node
from rclpy.node import Node


@pytest.mark.parametrize('namespace', [None, '/left'])
def test_a_node_name_is_found_in_any_namespace(run, namespace):
    run(Node, 'ik_service', namespace=namespace)
    expect_node('ik_service')


@pytest.mark.parametrize('name', ['ik_solver_node', 'ik_service_', 'IK_service'])
def test_a_node_of_another_name_fails(run, name):
    run(Node, name)
    words = rf"expected a node named ik_service, saw /{name}: write `super\(\).__init__\('ik_serv"
    with pytest.raises(CheckFailed, match=words):
        expect_node('ik_service')


@pytest.mark.starts
def test_a_missing_node_fails():
    with pytest.raises(CheckFailed, match='expected a node named ik_service, saw none: '):
        expect_node('ik_service')
