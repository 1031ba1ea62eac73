"""Pairs of QoS profiles are measured in a system of their own, and leave nothing behind."""

import pytest
from my_robot_basics.live import measure_pairs, run, stop, wait_until
from my_robot_basics.live.pictures import qos_pairs
from my_robot_basics.session.errors import WaitTimeout
from rclpy.node import Node
from rclpy.qos import QoSCompatibility, QoSProfile, ReliabilityPolicy, qos_check_compatible

PROFILES = {
    each.name: QoSProfile(depth=1, reliability=each)
    for each in (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT)
}


@pytest.fixture
def witness():
    yield run(Node, 'witness')
    stop()


def test_the_outcome_of_each_pair_agrees_with_qos_check_compatible(witness):
    outcome = measure_pairs(PROFILES)
    assert list(outcome) == [(offered, asked) for offered in PROFILES for asked in PROFILES]
    for (offered, asked), came_of_it in outcome.items():
        foretold, _ = qos_check_compatible(PROFILES[offered], PROFILES[asked])
        assert came_of_it == ('RELIABILITY' if foretold == QoSCompatibility.ERROR else 'yes')


def test_measuring_pairs_leaves_nothing_on_the_graph_and_logs_no_warning(witness, capfd):
    assert measure_pairs(PROFILES) == measure_pairs(PROFILES)
    wait_until(lambda: not [n for n in witness.get_node_names() if 'pair' in n])
    wait_until(lambda: not [n for n, _ in witness.get_topic_names_and_types() if 'pair' in n])
    logged = capfd.readouterr()
    assert 'incompatible' not in logged.out + logged.err


def test_a_pair_without_an_outcome_raises_a_timeout(monkeypatch):
    monkeypatch.setattr(qos_pairs, 'TIMEOUT_SEC', 0.0)
    with pytest.raises(WaitTimeout):
        measure_pairs(PROFILES)
