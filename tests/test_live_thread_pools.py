"""The threads of a MultiThreadedExecutor start each callback that is submitted to them."""

import os
import threading
import time

import pytest
import rclpy
from my_robot_basics.live.nodes import runner
from my_robot_basics.live.patches.thread_pools import THREADS, PromptPool
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32

NUMBERS = range(50)


class Echo(Node):
    """Publishes each number again."""

    def __init__(self):
        super().__init__('echo')
        group = ReentrantCallbackGroup()
        self.echo = self.create_publisher(Int32, '/echo', 10)
        self.create_subscription(Int32, '/number', self.echo.publish, 10, callback_group=group)
        self.create_subscription(Int32, '/other', print, 10, callback_group=group)


@pytest.fixture
def executor():
    runner.ensure_rclpy()
    executor = MultiThreadedExecutor(4)
    node = Echo()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    yield executor
    executor.shutdown()
    thread.join()
    node.destroy_node()


@pytest.mark.starts
def test_a_callback_is_not_submitted_to_the_thread_pool_again_and_again(executor, monkeypatch):
    handed_in = []
    submit = executor._executor.submit
    monkeypatch.setattr(
        executor._executor, 'submit', lambda fn: handed_in.append(fn) or submit(fn)
    )
    received = []
    node = rclpy.create_node('counter')
    numbers = node.create_publisher(Int32, '/number', 10)
    node.create_subscription(Int32, '/echo', lambda message: received.append(message.data), 10)
    counter = SingleThreadedExecutor()
    counter.add_node(node)

    def spin_until(is_true):
        deadline = time.monotonic() + 20
        while not is_true():
            assert time.monotonic() < deadline
            counter.spin_once(timeout_sec=0.1)

    spin_until(lambda: node.count_publishers('/echo') and numbers.get_subscription_count())
    for number in NUMBERS:
        numbers.publish(Int32(data=number))
        spin_until(lambda number=number: number in received)
    node.destroy_node()
    assert received == [*NUMBERS]
    # some are submitted again while the machine is busy; by rclpy alone, 31,000 and more
    assert len(handed_in) < 20 * len(NUMBERS)


def test_submitting_does_not_block_while_all_threads_are_busy():
    go_on = threading.Event()
    with PromptPool(1) as pool:
        first = pool.submit(go_on.wait)
        second = pool.submit(pow, 2, 3)
        assert not second.done()
        go_on.set()
        assert first.result() is True
        assert second.result() == 8
    with PromptPool(1) as pool, pytest.raises(ZeroDivisionError):
        pool.submit(divmod, 1, 0).result()


@pytest.mark.starts
@pytest.mark.parametrize('processors', [1, 9])
def test_the_number_of_threads_does_not_depend_on_the_machine(monkeypatch, processors):
    runner.ensure_rclpy()
    monkeypatch.setattr(os, 'sched_getaffinity', lambda _: {*range(processors)})
    monkeypatch.setattr(os, 'cpu_count', lambda: processors)
    executor = MultiThreadedExecutor()
    assert executor._executor._max_workers == THREADS
    executor.shutdown()


@pytest.mark.starts
def test_an_executor_has_as_many_threads_as_its_argument_says():
    runner.ensure_rclpy()
    executor = MultiThreadedExecutor(2)
    assert executor._executor._max_workers == 2
    executor.shutdown()
