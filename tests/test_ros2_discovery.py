"""When a look at the graph may end: with everybody there, on the operating system's word."""

from types import SimpleNamespace

import pytest
from my_robot_basics.graph import participants
from my_robot_basics.ros2 import discovery, environment
from ros2_command import on_the_graph, own_domain

TABLE = """\
   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode
 {rows}
"""
ROW = '31: 0100007F:{:04X} 00000000:0000 07 00000000:00000000 00:00000000 00000000 0 0 1 2 3 0'


@pytest.mark.parametrize(
    ('domain_id', 'ports', 'expected'),
    [
        (0, [], 0),
        (0, [7400, 7410, 7411], 1),  # multicast, announcements and data of one participant
        (0, [7400, 7410, 7411, 7412, 7413], 2),
        (0, [7400, 7410, 7410, 7411], 1),  # bound on two addresses
        (3, [8150, 8160, 8161, 7410, 8410], 1),  # others are in domains 0 and 4
        (101, [32650, 32660, 32661, 32898], 2),
    ],
)
def test_participants_are_counted_by_their_ports(
    domain_id, ports, expected, monkeypatch, tmp_path
):
    sockets = tmp_path / 'udp'
    sockets.write_text(TABLE.format(rows='\n '.join(map(ROW.format, ports))).rstrip() + '\n')
    monkeypatch.setattr(participants, 'SOCKETS', sockets)
    assert participants.count(domain_id) == expected
    monkeypatch.setattr(participants, 'SOCKETS', tmp_path / 'no file')
    assert participants.count(domain_id) == 0


def test_a_running_node_is_counted():
    with own_domain():
        domain_id = environment.domain_id()
        assert participants.count(domain_id) == 0
        with on_the_graph('five_hz', topics=('/kinematics/joint_states',)):
            assert participants.count(domain_id) == 1


class Clock:
    """Time passes when somebody waits."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def wait(self, seconds):
        self.now += seconds


class Seen:
    """Stands for an rclpy node that sees another participant and its endpoint at given times."""

    def __init__(self, clock, *, participant_at=0.0, endpoint_at=0.0, name_at=0.0):
        self.clock = clock
        self.times = participant_at, endpoint_at, name_at

    def _has(self, index):
        return self.clock.now >= self.times[index] - 1e-9

    def get_topic_names_and_types(self):
        return [('/topic', ['std_msgs/msg/String'])] if self._has(1) else []

    def get_node_names_and_namespaces(self):
        return [('talker', '/')] if self._has(2) else []

    def get_subscriptions_info_by_topic(self, name):
        return []

    def get_publishers_info_by_topic(self, name, no_mangle=False):
        if name == discovery.ANNOUNCEMENTS:
            return ['own', 'other'] if self._has(0) else ['own']
        node_name = 'talker' if self._has(2) else discovery.UNKNOWN
        return [SimpleNamespace(node_name=node_name, endpoint_gid=[1])] if self._has(1) else []


@pytest.mark.parametrize(
    ('seen', 'present', 'here_only', 'expected_sec'),
    [
        ({}, 2, True, 0.05),
        ({'participant_at': 0.2, 'endpoint_at': 0.21, 'name_at': 0.23}, 2, True, 0.28),
        ({'name_at': 0.5}, 2, True, 0.55),
        ({'participant_at': 0.9, 'endpoint_at': 0.9, 'name_at': 0.9}, 2, True, 0.95),
        ({}, 3, True, 1.0),  # one that never says anything
        ({}, 0, True, 0.05),  # the operating system tells nothing
        ({}, 2, False, 0.5),  # other machines may answer
        ({'endpoint_at': 9.0, 'name_at': 9.0, 'participant_at': 0.7}, 2, False, 0.75),
    ],
)
def test_it_ends_when_everybody_is_there(seen, present, here_only, expected_sec, monkeypatch):
    clock = Clock()
    monkeypatch.setattr(discovery, 'time', clock)
    monkeypatch.setattr(participants, 'count', lambda domain_id: present)
    monkeypatch.setattr(environment, 'hears_this_machine_only', lambda: here_only)
    discovery.settle(Seen(clock, **seen), clock.wait)
    assert clock.now == pytest.approx(expected_sec, abs=discovery.POLL_SEC * 1.5)


def test_a_graph_that_never_rests_ends_too(monkeypatch):
    clock = Clock()
    node = Seen(clock)
    node.get_topic_names_and_types = lambda: [(f'/topic_{clock.now}', [])]
    monkeypatch.setattr(discovery, 'time', clock)
    monkeypatch.setattr(participants, 'count', lambda domain_id: 2)
    discovery.settle(node, clock.wait)
    assert clock.now == pytest.approx(discovery.MOST_SEC, abs=discovery.POLL_SEC * 1.5)
