"""The QoS rule agrees with what really arrives, and its fix with its rule."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from made_evidence import infinite
from my_robot_basics.doctor.rules import endpoints
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

PROFILES = st.fixed_dictionaries(
    {
        'depth': st.integers(1, 20),
        'reliability': st.sampled_from(
            [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT]
        ),
        'durability': st.sampled_from(
            [DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL]
        ),
        'liveliness': st.sampled_from(
            [LivelinessPolicy.AUTOMATIC, LivelinessPolicy.MANUAL_BY_TOPIC]
        ),
    },
    optional={
        'deadline': st.sampled_from([Duration(seconds=1), Duration(seconds=60)]),
        'liveliness_lease_duration': st.sampled_from([Duration(seconds=1), Duration(seconds=60)]),
    },
)


@pytest.fixture(scope='module')
def both_ends():
    classroom.enter()
    with Watcher() as sender, Watcher() as receiver:
        yield sender, receiver


@pytest.mark.starts
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(offered=PROFILES, asked=PROFILES)
def test_the_qos_diagnosis_agrees_with_whether_messages_arrive(both_ends, offered, asked):
    sender, receiver = both_ends
    received = []
    publisher = sender.node.create_publisher(String, '/qos', QoSProfile(**offered))
    subscription = receiver.node.create_subscription(
        String, '/qos', received.append, QoSProfile(**asked)
    )
    look_ups = (
        receiver.node.get_publishers_info_by_topic,
        receiver.node.get_subscriptions_info_by_topic,
    )
    try:
        assert receiver.spin_until(
            lambda: all(len(look_up('/qos')) == 1 for look_up in look_ups), timeout_sec=10.0
        )
        (offer,), (wish,) = (look_up('/qos') for look_up in look_ups)
        gaps = endpoints.incompatible_policies(offer.qos_profile, wish.qos_profile)

        def arrives():
            publisher.publish(String())
            return bool(received)

        # a pair that matches does so within milliseconds
        assert receiver.spin_until(arrives, timeout_sec=0.3 if gaps else 10.0) is not bool(gaps)
        assert (publisher.get_subscription_count() == 0) == bool(gaps)
    finally:
        sender.node.destroy_publisher(publisher)
        receiver.node.destroy_subscription(subscription)
        receiver.spin_until(
            lambda: not any(look_up('/qos') for look_up in look_ups), timeout_sec=10.0
        )


@given(offered=PROFILES, asked=PROFILES)
def test_the_fix_for_any_profile_is_compatible_with_the_offer(offered, asked):
    given_, wanted = infinite(QoSProfile(**offered)), infinite(QoSProfile(**asked))
    gaps = endpoints.incompatible_policies(given_, wanted)
    if gaps:
        fixed = eval(endpoints._compatible_profile(given_, wanted), {**globals()})
        assert endpoints.incompatible_policies(given_, infinite(fixed)) == {}
