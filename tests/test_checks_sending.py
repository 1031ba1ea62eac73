"""A response reaches a client that a busy machine makes known late."""

import warnings

import pytest
from my_robot_basics.checks.services import sending
from my_robot_basics.checks.services.sending import ATTEMPTS, send_until_met, wait_for_readers
from my_robot_basics.graph.watcher import Watcher
from rclpy.node import Node
from std_srvs.srv import Trigger

from my_robot_basics import live

LOST = 'failed to send response (timeout)'


def lost_so_often(times, sent):
    def send():
        sent.append('a response')
        if len(sent) <= times:
            warnings.warn(f'{LOST}: client will not receive response', stacklevel=1)

    return send


@pytest.mark.parametrize(('lost', 'sent_times'), [(0, 1), (3, 4), (1_000, ATTEMPTS)])
def test_a_response_is_sent_again_until_its_client_is_discovered(recwarn, lost, sent_times):
    sent = []
    send_until_met(lost_so_often(lost, sent))
    assert len(sent) == sent_times
    assert not recwarn.list


def test_other_warnings_are_shown(monkeypatch):
    shown = []
    monkeypatch.setattr(
        sending.warnings, 'showwarning', lambda message, *_: shown.append(str(message))
    )
    send_until_met(lambda: warnings.warn('something else', stacklevel=1))
    assert shown == ['something else']


@pytest.fixture
def client():
    yield live.run(Node, 'asker', key='asker').create_client(Trigger, '/ask')
    live.stop()


def count_looks(node, service, *, unknown_times):
    """How often it looks for a reader that becomes known after n looks."""
    looks, look_up = [], node.get_subscriptions_info_by_topic

    def look_up_late(name, **options):
        looks.append(name)
        return look_up(name, **options) if len(looks) > unknown_times else []

    node.get_subscriptions_info_by_topic = look_up_late
    wait_for_readers(node, [service])
    return len(looks)


@pytest.mark.starts
@pytest.mark.usefixtures('client')
def test_a_response_waits_until_its_reader_is_discovered():
    with Watcher() as here:
        request = {'topic_name': 'rq/askRequest', 'no_mangle': True}
        assert here.spin_until(
            lambda: here.node.get_publishers_info_by_topic(**request), timeout_sec=20.0
        )
        assert count_looks(here.node, '/ask', unknown_times=2) == 3
        assert count_looks(here.node, '/nobody_asks', unknown_times=2) == 1


@pytest.mark.starts
@pytest.mark.usefixtures('client')
def test_wait_for_readers_waits_until_the_asking_client_is_on_the_graph():
    with Watcher() as here:
        look_up, looks = here.node.get_publishers_info_by_topic, []

        def look_up_late(name, **options):
            looks.append(name)
            return look_up(name, **options) if len(looks) > 2 else []

        request = {'topic_name': 'rq/askRequest', 'no_mangle': True}
        assert here.spin_until(lambda: look_up(**request), timeout_sec=20.0)
        here.node.get_publishers_info_by_topic = look_up_late
        wait_for_readers(here.node, ['/ask', '/nobody_asks'], asked='/ask')
        assert looks.count('rq/askRequest') >= 3
