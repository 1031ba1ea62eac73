"""The executor of a check's nodes: it handles everything that arrives, and reports errors."""

import contextlib
import os
import signal
import threading
import time

import pytest
from action_msgs.msg import GoalStatus
from my_robot_basics.graph.cell_context import new_context
from my_robot_basics.graph.ignored_callback_group import IgnoredCallbackGroup
from my_robot_basics.graph.lean_executor import LeanExecutor
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.task import Future
from std_msgs.msg import String

from arm_interfaces.action import MoveArm

pytestmark = pytest.mark.starts


@pytest.fixture
def watcher():
    with Watcher() as watcher:
        yield watcher


def send(watcher, *texts, topic='/talk'):
    """Publish these texts as soon as all subscriptions of that topic are matched."""
    node = watcher.node
    publisher = node.create_publisher(String, topic, 10)
    wanted = node.count_subscribers(topic)
    assert watcher.spin_until(
        lambda: publisher.get_subscription_count() == wanted, timeout_sec=10.0
    )
    for text in texts:
        publisher.publish(String(data=text))


def ask(watcher, answer, **options):
    """Return the future of a response, which `answer(request, response)` gives."""
    node = watcher.node
    node.create_service(GetParameters, '/ask', answer)
    client = node.create_client(GetParameters, '/ask', **options)
    assert watcher.spin_until(client.service_is_ready, timeout_sec=10.0)
    return client.call_async(GetParameters.Request())


def test_messages_are_received_in_order(watcher):
    heard = []
    watcher.node.create_subscription(String, '/talk', heard.append, 10)
    send(watcher, 'a', 'b', 'c')
    assert watcher.spin_until(lambda: len(heard) == 3, timeout_sec=10.0)
    assert [message.data for message in heard] == ['a', 'b', 'c']


def test_a_callback_with_two_parameters_gets_message_and_info(watcher):
    known = []

    def receive(message, info):
        known.append((message.data, info['source_timestamp'] > 0))

    watcher.node.create_subscription(String, '/talk', receive, 10)
    send(watcher, 'a')
    assert watcher.spin_until(lambda: known == [('a', True)], timeout_sec=10.0)


def test_a_service_answers_a_client(watcher):
    asked = ask(watcher, lambda _, response: response)
    assert watcher.spin_until(asked.done, timeout_sec=10.0)
    assert asked.result() == GetParameters.Response()


def test_a_service_callback_may_await_a_future(watcher):
    comes = Future()

    async def answer(_, response):
        await comes
        return response

    asked = ask(watcher, answer)
    assert not watcher.spin_until(asked.done, timeout_sec=0.2)
    comes.set_result(None)
    assert watcher.spin_until(asked.done, timeout_sec=10.0)


def test_a_client_in_an_ignored_callback_group_gets_no_response(watcher):
    asked = ask(watcher, lambda _, response: response, callback_group=IgnoredCallbackGroup())
    assert not watcher.spin_until(asked.done, timeout_sec=0.3)


def test_timers_and_guards_call_back_until_they_are_destroyed(watcher):
    calls = []
    timer = watcher.node.create_timer(0.01, lambda: calls.append('timer'))
    guard = watcher.node.create_guard_condition(lambda: calls.append('guard'))
    guard.trigger()
    assert watcher.spin_until(lambda: {*calls} == {'timer', 'guard'}, timeout_sec=10.0)
    watcher.node.destroy_timer(timer)
    calls.clear()
    watcher.spin_for(0.1)
    assert calls == []


def test_an_action_runs_from_goal_to_feedback_and_result(watcher):
    def execute(handle):
        handle.publish_feedback(MoveArm.Feedback())
        handle.succeed()
        return MoveArm.Result()

    server = ActionServer(watcher.node, MoveArm, '/move', execute)
    client = ActionClient(watcher.node, MoveArm, '/move')
    assert watcher.spin_until(client.server_is_ready, timeout_sec=10.0)
    feedback, results = [], []

    def accepted(future):
        future.result().get_result_async().add_done_callback(
            lambda ended: results.append(ended.result().status)
        )

    client.send_goal_async(MoveArm.Goal(), feedback.append).add_done_callback(accepted)
    assert watcher.spin_until(lambda: bool(results and feedback), timeout_sec=10.0)
    assert results == [GoalStatus.STATUS_SUCCEEDED]
    client.destroy()
    server.destroy()
    watcher.spin_for(0.1)


def test_a_subscription_made_in_a_callback_receives_messages(watcher):
    heard = []

    def receive(_):
        watcher.node.create_subscription(String, '/other', heard.append, 10)

    watcher.node.create_subscription(String, '/talk', receive, 10)
    send(watcher, 'a')
    assert watcher.spin_until(lambda: watcher.node.count_subscribers('/other'), timeout_sec=10.0)
    send(watcher, 'b', topic='/other')
    assert watcher.spin_until(lambda: bool(heard), timeout_sec=10.0)


def test_subscriptions_that_a_callback_destroys_are_not_called_again(watcher):
    calls, subscriptions = [], []

    def receive(message):
        calls.append(message.data)
        for subscription in subscriptions:
            watcher.node.destroy_subscription(subscription)

    for _ in range(2):
        subscriptions.append(watcher.node.create_subscription(String, '/talk', receive, 10))
    send(watcher, 'a', 'b')
    assert watcher.spin_until(lambda: bool(calls), timeout_sec=10.0)
    watcher.spin_for(0.1)
    assert calls == ['a']


def test_timers_that_a_callback_destroys_are_not_called_again(watcher):
    calls, timers = [], []

    def call():
        calls.append(1)
        for timer in timers:
            watcher.node.destroy_timer(timer)

    for _ in range(2):
        timers.append(watcher.node.create_timer(0.01, call))
    time.sleep(0.1)  # both are due
    watcher.spin_for(0.1)
    assert calls == [1]


def test_a_task_is_run_and_its_future_has_the_result(watcher):
    asked = watcher.node.executor.create_task(lambda: 'done')
    assert watcher.spin_until(asked.done, timeout_sec=10.0)
    assert asked.result() == 'done'


def raise_error(*_):
    raise ValueError('of a callback')


def in_a_subscription(watcher):
    watcher.node.create_subscription(String, '/talk', raise_error, 10)
    send(watcher, 'a')


def in_a_service(watcher):
    ask(watcher, raise_error)


def in_a_done_callback(watcher):
    ask(watcher, lambda _, response: response).add_done_callback(raise_error)


def in_a_timer(watcher):
    watcher.node.create_timer(0.01, raise_error)


def in_a_task(watcher):
    watcher.node.executor.create_task(raise_error)


@pytest.mark.parametrize(
    'happens', [in_a_subscription, in_a_service, in_a_done_callback, in_a_timer, in_a_task]
)
def test_an_exception_of_a_callback_ends_the_check(watcher, happens):
    happens(watcher)
    with pytest.raises(ValueError, match='of a callback'):
        watcher.spin_for(10.0)


def test_an_interrupt_ends_a_check_that_waits():
    interrupt = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    watcher = Watcher()

    def check():
        with watcher:
            interrupt.start()
            watcher.spin_for(60.0)

    with pytest.raises(KeyboardInterrupt):
        check()
    assert not watcher.context.ok()


def test_a_closed_watcher_leaves_no_thread_node_or_callback():
    threads, heard = {*threading.enumerate()}, []
    with Watcher() as watcher:
        watcher.node.create_subscription(String, '/talk', heard.append, 10)
        executor = watcher.node.executor
        send(watcher, 'a')
    assert {*threading.enumerate()} == threads
    assert executor.get_nodes() == []
    executor.spin_once(timeout_sec=0.1)
    assert heard == []


def test_a_wait_ends_if_its_context_is_shut_down():
    executor = LeanExecutor(context=new_context(classroom.enter()))
    executor.spin_once(timeout_sec=0.1)
    later = threading.Timer(0.3, executor.context.shutdown)
    later.start()
    with contextlib.suppress(ExternalShutdownException):  # the wait may end in both ways
        executor.spin_once()
    later.join()
    with pytest.raises(ExternalShutdownException):
        executor.spin_once(timeout_sec=60.0)
    executor.shutdown()
