"""Which messages arrive on a stage; none counts as lost before it could arrive."""

import pytest
from my_robot_basics.checks.values import delivery_experiment as stage_module
from my_robot_basics.checks.values.delivery_experiment import DidNotRun, Stage
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from std_msgs.msg import Int32


@pytest.fixture(scope='module')
def participants():
    with Watcher() as senders, Watcher() as receivers:
        yield senders, receivers


@pytest.fixture
def stage(participants):
    return Stage(*participants)


def test_a_subscription_receives_only_messages_published_after_it_was_made(stage):
    publisher = stage.publisher('/pose')
    early = publisher.publish()
    subscription = stage.subscription('/pose')
    now = publisher.publish()
    assert subscription.received(now)
    assert not subscription.received(early)
    assert not subscription.received(early, now)


@pytest.mark.parametrize(
    ('publisher', 'subscription', 'arrives'),
    [
        ({'topic_name': 'pose'}, {'topic_name': '/pose'}, True),
        ({'topic_name': '/pose'}, {'topic_name': 'pose'}, True),
        ({'topic_name': '/pose'}, {'topic_name': '/Pose'}, False),
        ({'topic_name': 'pose', 'namespace': '/arm'}, {'topic_name': '/pose'}, False),
        ({'topic_name': 'pose', 'namespace': '/arm'}, {'topic_name': '/arm/pose'}, True),
        ({'topic_name': '/pose', 'namespace': '/arm'}, {'topic_name': '/pose'}, True),
        ({'topic_name': '/pose'}, {'topic_name': 'pose', 'namespace': '/arm'}, False),
        ({'topic_name': 'pose', 'remap': 'pose:=/shown'}, {'topic_name': '/shown'}, True),
        ({'topic_name': 'pose', 'remap': 'pose:=/shown'}, {'topic_name': '/pose'}, False),
        ({'topic_name': '/pose', 'type_': Int32}, {'topic_name': '/pose', 'type_': Int32}, True),
        ({'topic_name': '/pose', 'type_': Int32}, {'topic_name': '/pose'}, False),
    ],
)
def test_messages_arrive_only_if_topic_name_and_type_match(
    stage, publisher, subscription, arrives
):
    sender, receiver = stage.publisher(**publisher), stage.subscription(**subscription)
    assert receiver.received(sender.publish()) is arrives


def test_each_subscription_receives_from_each_publisher(stage):
    publishers = [stage.publisher('/pose') for _ in range(3)]
    subscriptions = [stage.subscription('/pose') for _ in range(2)]
    messages = [publisher.publish() for publisher in publishers]
    assert all(subscription.received(*messages) for subscription in subscriptions)


def test_a_closed_subscription_does_not_stop_a_publisher(stage):
    publisher, closed = stage.publisher('/pose'), stage.subscription('/pose')
    closed.close()
    unheard = publisher.publish()
    again = stage.subscription('/pose')
    assert again.received(publisher.publish())
    assert not again.received(unheard)


def test_messages_of_one_stage_do_not_reach_another_stage(participants):
    one, other = Stage(*participants), Stage(*participants)
    publisher, subscription = one.publisher('/pose'), other.subscription('/pose')
    ninth = [publisher.publish() for _ in range(9)][-1]
    own = other.publisher('/pose').publish()
    assert subscription.received(own)
    assert not subscription.received(ninth)


def test_the_nodes_of_a_stage_are_hidden(stage, participants):
    stage.publisher('/pose')
    names = participants[0].node.get_node_names()
    assert names
    assert all(name.startswith('_') for name in names)


def test_an_experiment_without_discovery_raises_did_not_run(monkeypatch):
    monkeypatch.setattr(stage_module, 'TIMEOUT_SEC', 0.3)
    elsewhere = 1 + classroom.enter() % 101
    with Watcher() as senders, Watcher(domain_id=elsewhere) as receivers:
        stage = Stage(senders, receivers)
        publisher, subscription = stage.publisher('/pose'), stage.subscription('/pose')
        with pytest.raises(DidNotRun, match='your answer is not the cause'):
            publisher.publish()
        with pytest.raises(DidNotRun):
            subscription.received()
