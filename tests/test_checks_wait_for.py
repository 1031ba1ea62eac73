"""`Topic.publish` and `Topic.wait_for`: a node that answers one topic on another one."""

import math

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PointStamped
from grade_cell import grade_cell
from my_robot_basics.checks import CheckFailed, topic
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

pytestmark = pytest.mark.usefixtures('patient')


class Echo(Node):
    """Answers each Point with a JointState."""

    def __init__(self, qos_profile):
        super().__init__('echo')
        self.publisher = self.create_publisher(JointState, '/answer', 10)
        self.create_subscription(Point, '/question', self.answer, qos_profile)

    def answer(self, point):
        stamp = self.get_clock().now().to_msg()
        message = JointState(position=[point.x, point.y])
        message.header.stamp = stamp
        self.publisher.publish(message)


@pytest.mark.slow
@pytest.mark.parametrize(
    'reliability', [ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT]
)
@pytest.mark.parametrize(
    'durability', [DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL]
)
def test_wait_for_returns_the_answer_to_a_published_message(run, reliability, durability):
    run(Echo, QoSProfile(depth=10, reliability=reliability, durability=durability))
    message = topic('/answer').wait_for(
        lambda message: message.position[0] == 1.5,
        after=lambda: topic('/question').publish(Point(x=0.5), Point(x=1.5)),
    )
    assert message.header.stamp != Time()


@pytest.mark.slow
def test_publishing_without_a_subscription_fails(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed, match='/echo uses /question, so compare the spelling'):
        topic('/questions').publish(Point(), timeout_sec=0.5)


@pytest.mark.slow
def test_a_wrong_answer_does_not_count(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed, match='expected a message on /answer that answers, saw 1 oth'):
        topic('/answer').wait_for(
            lambda message: message.position[0] == 9.0,
            timeout_sec=1.0,
            after=lambda: topic('/question').publish(Point()),
        )


@pytest.mark.slow
def test_publishing_to_a_subscription_of_another_type_names_the_type(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed) as failed:
        topic('/question').publish(JointState(), timeout_sec=0.5)
    assert 'a subscription on /question for JointState, saw none' in str(failed.value)
    assert 'one is there for geometry_msgs/msg/Point' in str(failed.value)


def test_an_answer_of_another_type_is_named(run):
    """A look for its fields would find none."""
    run(Echo, 10)
    words = 'expected PointStamped messages on /answer, saw JointState: compare the message type'
    with pytest.raises(CheckFailed, match=words):
        topic('/answer').wait_for(lambda message: message.point.x == 0.5, type_=PointStamped)


@pytest.mark.slow
def test_a_best_effort_subscription_receives_the_published_message(run):
    run(Echo, QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    for number in range(5):
        topic('/answer').wait_for(
            lambda message, x=float(number): message.position[0] == x,
            after=lambda x=float(number): topic('/question').publish(Point(x=x)),
        )


def test_a_wrong_answer_is_reported_in_the_words_of_the_check(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed) as failed:
        topic('/answer').wait_for(
            lambda message: message.position[0] == 9.0,
            timeout_sec=1.0,
            after=lambda: topic('/question').publish(Point(x=1.5)),
            expected='9.0',
            seen=lambda message: message.position[0],
            hint='count again',
        )
    assert str(failed.value) == 'expected 9.0, saw 1.5: count again'


@pytest.mark.slow
@pytest.mark.parametrize('right', [0.5, 1.5])
def test_a_forbidden_answer_beside_the_right_one_fails(run, right):
    run(Echo, 10)
    with pytest.raises(CheckFailed, match=f'expected only that, saw {2.0 - right}: leave it out'):
        topic('/answer').wait_for(
            lambda message: message.position[0] == right,
            never=lambda message: message.position[0] == 2.0 - right,
            after=lambda: topic('/question').publish(Point(x=0.5), Point(x=1.5)),
            expected='only that',
            seen=lambda message: message.position[0],
            hint='leave it out',
        )


@pytest.mark.slow
@pytest.mark.timeout(60)
def test_a_forbidden_answer_alone_fails_without_a_wait(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed, match=r'expected 9\.0, saw 0\.5: count again'):
        topic('/answer').wait_for(
            lambda message: message.position[0] == 9.0,
            never=lambda message: message.position[0] == 0.5,
            timeout_sec=math.inf,
            after=lambda: topic('/question').publish(Point(x=0.5)),
            expected='9.0',
            seen=lambda message: message.position[0],
            hint='count again',
        )


class Repeats(Echo):
    """Answers a question again and again"""

    def answer(self, question):
        self.create_timer(0.1, lambda: super(Repeats, self).answer(question))


def ask_once(*, is_it=None, questions=1, **options):
    ask = [Point(x=0.5)] * questions
    topic('/answer').wait_for(
        is_it, once=True, after=lambda: topic('/question').publish(*ask), **options
    )


def is_half(message):
    return message.position[0] == 0.5


@pytest.mark.slow
def test_a_single_answer_passes_if_one_is_expected(run):
    run(Echo, 10)
    ask_once(is_it=is_half)


@pytest.mark.slow
def test_two_answers_fail_if_one_is_expected(run):
    run(Echo, 10)
    with pytest.raises(CheckFailed, match='saw 2 messages'):
        ask_once(is_it=is_half, questions=2)


class AnswersInParts(Echo):
    """Publishes a first half of each answer, too"""

    def answer(self, point):
        self.publisher.publish(JointState(position=[point.x]))
        super().answer(point)


@pytest.mark.slow
def test_a_partial_answer_beside_the_whole_one_fails(run):
    run(AnswersInParts, 10)
    with pytest.raises(CheckFailed, match='saw 2 messages: publish once in each call'):
        ask_once(is_it=lambda message: len(message.position) == 2)


@pytest.mark.slow
def test_an_answer_repeated_by_a_timer_fails(run):
    run(Repeats, 10)
    with pytest.raises(CheckFailed, match='expected one message for each that your node receives'):
        ask_once(is_it=is_half)


class TalksBefore(Echo):
    """Publishes until the first question comes"""

    def __init__(self, *args):
        super().__init__(*args)
        self.waiting = self.create_timer(0.1, lambda: self.publisher.publish(JointState()))

    def answer(self, question):
        self.waiting.cancel()
        super().answer(question)


@pytest.mark.slow
def test_messages_before_the_first_question_fail(run):
    run(TalksBefore, 10)
    with pytest.raises(CheckFailed, match='saw messages before it has received any: publish once'):
        ask_once(is_it=is_half)


class AnswersEachOther(Echo):
    """Answers only every second question"""

    is_next = False

    def answer(self, question):
        self.is_next = not self.is_next
        if self.is_next:
            super().answer(question)


class AnswersTheOneBefore(Echo):
    before = None

    def answer(self, question):
        if self.before is not None:
            super().answer(self.before)
        self.before = question


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (AnswersEachOther, 'others answered, and this one not: publish in every call'),
        (AnswersTheOneBefore, 'the first one only when a second was sent: publish what you make'),
    ],
)
def test_skipped_answers_are_distinguished_from_delayed_ones(run, monkeypatch, node_class, reason):
    def ask_twice():
        for _ in range(2):
            ask_once(timeout_sec=1.0)

    run(node_class, 10)
    with grade_cell(monkeypatch), pytest.raises(CheckFailed, match=reason):
        ask_twice()
