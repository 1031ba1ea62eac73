"""Discovery ends when all participants and all their announced endpoints are known."""

import contextlib
import re
import socket
import time
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from my_robot_basics.graph import entities, participants, reannouncing
from my_robot_basics.ros2 import discovery, environment
from rclpy.context import Context
from rclpy.node import Node
from ros2_command import TIMEOUT_SEC, on_the_graph, own_domain, plain_nodes, ros2

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


def test_a_running_node_counts_as_one_participant():
    with own_domain():
        domain_id = environment.domain_id()
        assert participants.count(domain_id) == 0
        with on_the_graph('five_hz', topics=('/kinematics/joint_states',)):
            assert participants.count(domain_id) == 1


def test_a_process_knows_its_own_ports():
    with own_domain(), on_the_graph('five_hz', topics=('/kinematics/joint_states',)):
        domain_id = environment.domain_id()
        others = participants.ports(domain_id)
        assert participants.own_ports(domain_id) == set()
        with observer():
            own = participants.own_ports(domain_id)
            assert participants.ports(domain_id) == own | others
        assert len(own) == 1
        assert len(others) == 1


@contextlib.contextmanager
def observer():
    """A node of this process, in the domain of the environment."""
    context = Context()
    context.init(domain_id=environment.domain_id())
    node = Node('observer', context=context, start_parameter_services=False)
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def test_an_asked_participant_announces_itself_to_the_reply_port_and_logs_nothing():
    with own_domain(), plain_nodes(2, 1) as process:
        theirs = participants.ports(environment.domain_id())
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
            listener.bind((reannouncing.LOOPBACK, 0))
            listener.settimeout(TIMEOUT_SEC)
            reannouncing.ask_ports(theirs, reply_port=listener.getsockname()[1])
            announced = listener.recv(65536)
        names = ros2('node', 'list', '--all').out
        time.sleep(reannouncing.LEASE_SEC + 0.5)  # they forget whom they have answered
        assert process.poll() is None
        process.terminate()
        assert process.communicate() == ('', '')
    assert announced.startswith(b'RTPS')
    assert b'enclave=/' in announced  # every ROS participant announces its enclave
    assert re.fullmatch(r'/_ros2cli_\d+\n/plain_0\n/plain_1\n', names)


def test_participants_announce_the_nodes_and_endpoints_that_the_graph_shows():
    with own_domain(), plain_nodes(3, 2), observer() as node:
        ends: set[bytes] = set()
        with entities.Reader(node) as reader:
            until = time.monotonic() + TIMEOUT_SEC
            while len(reader.read()) < 3 or not expected_ends(reader) <= ends:
                assert time.monotonic() < until, reader.read()
                reannouncing.ask(environment.domain_id())
                time.sleep(0.1)
                ends = {
                    bytes(info.endpoint_gid)
                    for name, _ in node.get_topic_names_and_types(no_demangle=True)
                    for look_up in (
                        node.get_publishers_info_by_topic,
                        node.get_subscriptions_info_by_topic,
                    )
                    for info in look_up(name, no_mangle=True)
                }
            said = reader.read().values()
    nodes = sorted(sorted(each.nodes) for each in said)
    assert nodes == [[('observer', '/')], [('plain_0', '/'), ('plain_2', '/')], [('plain_1', '/')]]
    unsaid = ends - {end for each in said for end in each.endpoints}
    assert len(unsaid) == 6  # on these the three announce their entities and receive announcements


def expected_ends(reader):
    return {end for each in reader.read().values() for end in each.endpoints}


GID, READER, WRITER = bytes(range(16)), bytes(16), bytes([7] * 16)
SAID = (
    *(b'\0\1\0\0', GID, b'\1\0\0\0', b'\2\0\0\0/\0\0\0', b'\7\0\0\0talker\0\0'),
    *(b'\1\0\0\0', READER, b'\1\0\0\0', WRITER),
)


def test_an_announcement_of_entities_is_parsed():
    assert entities.parse(b''.join(SAID)) == (
        GID,
        entities.Entities(frozenset({('talker', '/')}), frozenset({READER, WRITER})),
    )


@given(message=st.binary(max_size=80) | st.integers(0, 80).map(lambda n: b''.join(SAID)[:n]))
def test_an_arbitrary_announcement_is_parsed_or_refused_with_a_value_error(message):
    try:
        gid, said = entities.parse(message)
    except ValueError:
        return
    assert len(gid) == len(GID)
    assert isinstance(said, entities.Entities)


@pytest.mark.parametrize('length', [0, 3, 19, 23, 40, len(b''.join(SAID)) - 1])
def test_a_truncated_announcement_is_refused(length):
    with pytest.raises(ValueError, match='the message ends at'):
        entities.parse(b''.join(SAID)[:length])


class Clock:
    """Time passes when somebody waits."""

    def __init__(self):
        self.now = 0.0

    def monotonic(self):
        return self.now

    def wait(self, seconds):
        self.now += seconds


class FakeObserver:
    """Replaces an rclpy node that discovers another participant's endpoint at given times.

    It replaces the reader of announced entities as well.
    """

    def __init__(self, clock, *, said_at=0.0, endpoint_at=0.0, name_at=0.0):
        self.clock = clock
        self.times = said_at, endpoint_at, name_at

    def _has(self, index):
        return self.clock.now >= self.times[index] - 1e-9

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def read(self):
        own = {b'own': entities.Entities(frozenset(), frozenset())}
        other = entities.Entities(frozenset({('talker', '/')}), frozenset({b'end'}))
        return own | {b'other': other} if self._has(0) else own

    def get_topic_names_and_types(self, no_demangle):
        return [('rt/topic', ['std_msgs::msg::dds_::String_'])] if self._has(1) else []

    def get_node_names_and_namespaces(self):
        return [('talker', '/')] if self._has(2) else []

    def get_subscriptions_info_by_topic(self, name, no_mangle):
        return []

    def get_publishers_info_by_topic(self, name, no_mangle):
        node_name = 'talker' if self._has(2) else discovery.UNKNOWN
        return [SimpleNamespace(node_name=node_name, endpoint_gid=b'end')]


def settled_after(monkeypatch, seen, *, present=2, here_only=True):
    """Return when discovery has ended and when it has asked for announcements, in seconds."""
    clock, asked = seen.clock, []
    monkeypatch.setattr(discovery, 'time', clock)
    monkeypatch.setattr(participants, 'count', lambda domain_id: present)
    monkeypatch.setattr(environment, 'is_localhost_only', lambda: here_only)
    monkeypatch.setattr(entities, 'Reader', lambda node: seen)
    monkeypatch.setattr(reannouncing, 'ask', lambda domain_id: asked.append(clock.now))
    discovery.settle(seen, clock.wait)
    return clock.now, asked


@pytest.mark.parametrize(
    ('seen', 'present', 'here_only', 'expected_sec'),
    [
        ({}, 2, True, 0.05),
        ({'said_at': 0.2, 'endpoint_at': 0.21, 'name_at': 0.23}, 2, True, 0.28),
        ({'name_at': 0.5}, 2, True, 0.55),
        ({'endpoint_at': 1.5}, 2, True, 1.55),  # it is announced, so waited for
        ({'said_at': 0.9, 'endpoint_at': 0.9, 'name_at': 0.9}, 2, True, 0.95),
        ({}, 3, True, 2.0),  # one never announces anything
        ({}, 0, True, 0.05),  # the operating system shows no sockets
        ({}, 2, False, 0.5),  # other machines may answer
        ({'said_at': 0.7}, 2, False, 0.75),
    ],
)
def test_discovery_ends_once_all_participants_are_known_or_a_limit_is_reached(
    seen, present, here_only, expected_sec, monkeypatch
):
    took_sec, _ = settled_after(
        monkeypatch, FakeObserver(Clock(), **seen), present=present, here_only=here_only
    )
    assert took_sec == pytest.approx(expected_sec, abs=discovery.POLL_SEC * 1.5)


def test_missing_participants_are_asked_less_and_less_often(monkeypatch):
    _, asked = settled_after(monkeypatch, FakeObserver(Clock(), said_at=0.4))
    assert asked == pytest.approx([0.0, 0.05, 0.15, 0.35], abs=discovery.POLL_SEC * 3.5)


def test_no_participant_is_asked_if_none_is_missing(monkeypatch):
    _, asked = settled_after(monkeypatch, FakeObserver(Clock(), endpoint_at=0.4))
    assert asked == []


def test_discovery_ends_on_a_graph_that_never_settles(monkeypatch):
    seen = FakeObserver(Clock())
    seen.get_node_names_and_namespaces = lambda: [('talker', '/'), (f'n{seen.clock.now}', '/')]
    took_sec, _ = settled_after(monkeypatch, seen)
    assert took_sec == pytest.approx(discovery.MOST_SEC, abs=discovery.POLL_SEC * 1.5)
