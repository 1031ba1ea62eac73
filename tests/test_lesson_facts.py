"""Facts that lessons state in passing and do not show: each is tested here."""

import os
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest
import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from answered import read
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.ros2.verbs.topic_hz import Rate
from rcl_interfaces.msg import SetParametersResult
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_profile_action_status_default
from rclpy.task import Future
from std_msgs.msg import Int32, String

from arm_interfaces.action import MoveArm

ROOT = Path(__file__).parents[1]
EXECUTORS = """
import rclpy
from my_robot_basics.live import run, stop
from rclpy.node import Node

print(type(run(Node, 'spun').executor).__name__, type(rclpy.get_global_executor()).__name__)
stop()
"""


@pytest.mark.starts
def test_run_and_spin_use_a_single_threaded_executor():
    """Lesson 4; `rclpy.spin` takes the global one if it is given none."""
    done = subprocess.run(
        [sys.executable, '-c', EXECUTORS], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1].split()[-2:] == ['SingleThreadedExecutor'] * 2


@pytest.mark.starts
@pytest.mark.parametrize('calls', [1, 2])
def test_a_second_init_of_a_program_raises_a_runtime_error(calls):
    """Lesson 3."""
    code = 'import rclpy\n' + calls * 'rclpy.init()\n' + "print('went on')"
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert ('went on' in done.stdout) == (calls == 1)
    assert ('\nRuntimeError: ' in done.stderr) == (calls == 2)


BLOCKING = """
import time
from threading import Thread

import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool

rclpy.init()
patient = Node('patient')
patient.create_service(SetBool, '/patient/wake', lambda request, response: response)
client = patient.create_client(SetBool, '/patient/wake')
asked = []

def ask():
    asked.append('asked')
    if WAITS_IN_A_CALLBACK:
        client.call(SetBool.Request())
        asked.append('answered')

patient.create_timer(0.1, ask)
spinning = Thread(target=rclpy.spin, args=[patient], daemon=True)
spinning.start()
while not asked:
    time.sleep(0.01)
spinning.join(2.0)
print(spinning.is_alive(), len(asked) > 1, flush=True)
"""


@pytest.mark.starts
@pytest.mark.parametrize('waits_in_a_callback', [False, True])
def test_spin_does_not_return_and_a_call_in_a_callback_never_does(waits_in_a_callback):
    """Lesson 7: `rclpy.spin` goes on for ever; the timer ticks on, unless a callback waits."""
    script = f'WAITS_IN_A_CALLBACK = {waits_in_a_callback}{BLOCKING}import os; os._exit(0)'
    done = subprocess.run(
        [sys.executable, '-c', script], capture_output=True, text=True, timeout=60
    )
    is_spinning, ticks_on = done.stdout.split()
    assert (is_spinning, ticks_on) == ('True', str(not waits_in_a_callback)), done.stderr


@pytest.mark.starts
def test_callbacks_of_a_node_are_in_one_mutually_exclusive_group_by_default():
    """Lesson 4; the callbacks of a node exclude each other unless they get other groups."""
    with Watcher() as watcher:
        node = watcher.node
        made = [node.create_timer(9.0, print), node.create_subscription(String, '/s', print, 1)]
        assert {entity.callback_group for entity in made} == {node.default_callback_group}
        assert isinstance(node.default_callback_group, MutuallyExclusiveCallbackGroup)


@pytest.mark.starts
def test_publisher_and_subscription_get_an_event_for_incompatible_qos():
    """Lesson 6: incompatible QoS is an event for the publisher, too."""
    told = set()
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    offers = PublisherEventCallbacks(incompatible_qos=lambda _: told.add('publisher'))
    requests = SubscriptionEventCallbacks(incompatible_qos=lambda _: told.add('subscription'))
    with Watcher() as watcher:
        node = watcher.node
        node.create_publisher(Int32, '/_offered', best_effort, event_callbacks=offers)
        node.create_subscription(Int32, '/_offered', print, 1, event_callbacks=requests)
        assert watcher.spin_until(lambda: len(told) == 2, timeout_sec=10.0), told


@pytest.mark.starts
def test_two_types_on_one_topic_never_match_and_cause_no_event():
    """Lesson 1: in two programs (contexts) nobody warns; a third end shows that they have met."""
    told = []
    offers = PublisherEventCallbacks(incompatible_type=told.append, incompatible_qos=told.append)
    requests = SubscriptionEventCallbacks(
        incompatible_type=told.append, incompatible_qos=told.append
    )
    with Watcher() as here, Watcher() as there:
        here.node.create_subscription(String, '/_typed', told.append, 1, event_callbacks=requests)
        numbers = there.node.create_publisher(Int32, '/_typed', 1, event_callbacks=offers)
        there.node.create_subscription(Int32, '/_typed', lambda _: None, 1)
        for watcher in here, there:
            assert watcher.spin_until(
                lambda: there.node.count_subscribers('/_typed') == 2, timeout_sec=10.0
            )
        numbers.publish(Int32(data=1))
        for watcher in here, there:
            watcher.spin_until(lambda: bool(told), timeout_sec=1.0)
        assert numbers.get_subscription_count() == 1
        assert told == []


@pytest.mark.starts
def test_a_message_does_not_say_who_sent_it():
    """Lesson 1; nor does the message info that rclpy passes to a callback."""
    told = []
    with Watcher() as watcher:
        publisher = watcher.node.create_publisher(String, '/_said', 1)
        watcher.node.create_subscription(String, '/_said', lambda _, info: told.append(info), 1)
        watcher.spin_until(lambda: publisher.get_subscription_count() > 0, timeout_sec=10.0)
        publisher.publish(String(data='elbow up'))
        assert watcher.spin_until(lambda: bool(told), timeout_sec=10.0)
    words = [*String.get_fields_and_field_types(), *told[0]]
    assert words[0] == 'data'
    assert all('timestamp' in word or 'sequence_number' in word for word in words[1:]), words


def test_the_window_of_topic_hz_counts_gaps_between_messages(capsys):
    """Lesson 5; four messages, half a second apart, have three gaps."""
    now_nsec = 10**9
    rate = Rate(lambda: now_nsec, window_size=10)
    for _ in range(4):
        rate.arrival()
        now_nsec += 5 * 10**8
    assert 'average rate: 2.000' in (said := capsys.readouterr().out)
    assert said.endswith('window: 3\n')


@pytest.mark.parametrize('tool', ['launch', 'tf2_ros', 'rosbag2_py', 'urdf_parser_py', 'rviz2'])
def test_tools_that_come_after_the_course_are_not_installed(tool):
    """What next: these tools need a ROS 2 of one's own."""
    assert find_spec(tool) is None
    assert shutil.which(tool, path=str(Path(sys.executable).parent)) is None


LEFT_OUT = ['launch', 'tf2', 'URDF', 'RViz', 'simulation', 'bags', 'several machines']
IN_CHINESE = {'simulation': '仿真', 'bags': 'bag 文件', 'several machines': '多台计算机'}


@pytest.mark.parametrize('what', LEFT_OUT)
def test_each_left_out_subject_has_a_row_and_a_link_in_what_next(what):
    """The course has no packages of the subject, and the page says where to read on."""
    for folder, name in ('.', what), ('zh_CN', IN_CHINESE.get(what, what)):
        page = (ROOT / 'notebooks' / folder / 'what_next.md').read_text(encoding='utf-8')
        (row,) = (line for line in page.splitlines() if line.startswith(f'| {name} |'))
        assert '](https://docs.ros.org/en/jazzy/' in row


def test_a_lesson_looks_for_nodes_on_its_own_machine_only():
    """What next; `enter` has set this for the session of these tests, as for every lesson."""
    assert os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'


def test_rclpy_action_can_cancel_goals_and_publish_feedback():
    """Lesson 7; an action can be cancelled, and publishes its progress."""
    assert callable(ClientGoalHandle.cancel_goal_async)
    assert callable(ServerGoalHandle.publish_feedback)


@pytest.mark.starts
@pytest.mark.parametrize('end', ['succeed', 'canceled', 'abort'])
def test_a_goal_that_is_being_cancelled_ends_as_its_server_says(end):
    """Lesson 9: the arm may still move; `canceled()` ends the goal, as the others would."""
    asked = Future()

    def accept(_):
        asked.set_result(None)
        return CancelResponse.ACCEPT

    async def execute(handle):
        await asked
        getattr(handle, end)()
        return MoveArm.Result()

    with Watcher() as watcher, served(watcher, execute, cancel_callback=accept) as client:
        handle = answer(watcher, client.send_goal_async(MoveArm.Goal()))
        canceling = answer(watcher, handle.cancel_goal_async()).goals_canceling
        assert [info.goal_id for info in canceling] == [handle.goal_id]
        status = answer(watcher, handle.get_result_async()).status
    ends = {'succeed': 'SUCCEEDED', 'canceled': 'CANCELED', 'abort': 'ABORTED'}
    assert status == getattr(GoalStatus, f'STATUS_{ends[end]}')


@pytest.mark.starts
def test_a_rejected_goal_never_has_a_state():
    """Lesson 9: the status topic has no state of it, but has one of the next goal."""
    told = []

    async def execute(handle):
        handle.succeed()
        return MoveArm.Result()

    def judge(goal):
        return GoalResponse.ACCEPT if goal.speed else GoalResponse.REJECT

    def is_told(goal):
        ids = [each.goal_info.goal_id for message in told for each in message.status_list]
        return goal.goal_id in ids

    with Watcher() as watcher, served(watcher, execute, goal_callback=judge) as client:
        qos_profile = qos_profile_action_status_default
        topic_name = '/_move/_action/status'
        watcher.node.create_subscription(GoalStatusArray, topic_name, told.append, qos_profile)
        rejected = answer(watcher, client.send_goal_async(MoveArm.Goal()))
        accepted = answer(watcher, client.send_goal_async(MoveArm.Goal(speed=1.0)))
        assert (rejected.accepted, accepted.accepted) == (False, True)
        answer(watcher, accepted.get_result_async())
        assert watcher.spin_until(lambda: is_told(accepted), timeout_sec=10.0)
    assert not is_told(rejected)


@pytest.mark.starts
@pytest.mark.parametrize('waits', ['execute', 'a timer'])
def test_callbacks_run_while_an_execute_callback_awaits_but_not_while_a_timer_does(waits):
    """Lesson 9: an execute callback is in no group; a coroutine of lesson 8 blocks its own."""
    started, ticks = [], []

    async def wait(handle=None):
        once.cancel()
        started.append(time.monotonic())
        await Future()  # for ever
        return handle

    with spun() as (node, spin_until):
        once = node.create_timer(0.01, wait if waits == 'a timer' else lambda: once.cancel())
        server = ActionServer(node, MoveArm, '/_waits', wait)
        client = ActionClient(node, MoveArm, '/_waits')
        if waits == 'execute':
            assert spin_until(client.server_is_ready)
            client.send_goal_async(MoveArm.Goal())
        assert spin_until(lambda: started)
        node.create_timer(0.01, lambda: ticks.append(time.monotonic()))
        assert spin_until(lambda: len(ticks) > 3, 10.0 if waits == 'execute' else 0.5) == (
            waits == 'execute'
        )
        client.destroy()
        server.destroy()


@pytest.mark.starts
def test_a_parameter_callback_does_not_know_whether_another_one_refuses():
    """Lesson 11: one callback accepts, another one refuses; the value stays, and none acts."""
    called = []

    def judge(name, successful):
        called.append(name)
        return SetParametersResult(successful=successful, reason='the other one says no')

    with spun() as (node, _):
        node.declare_parameter('level', 40)
        for name, successful in ('no', False), ('yes', True):  # the last one is called first
            node.add_on_set_parameters_callback(
                lambda _, name=name, successful=successful: judge(name, successful)
            )
        node.add_post_set_parameters_callback(lambda _: called.append('act'))
        (result,) = node.set_parameters([Parameter('level', value=70)])
        assert (result.successful, result.reason) == (False, 'the other one says no')
        assert called == ['yes', 'no']
        assert node.get_parameter('level').value == 40


def test_lesson_12_names_the_course_packages_that_a_robot_needs_for_the_player():
    """Lesson 12: rosdep knows none of them."""
    (robot,) = (
        cell.source for cell in read('solutions', '12_package').cells if cell.id == 'robot'
    )
    course = {path.parent.name for path in ROOT.glob('*/package.xml')}
    xml = (ROOT / 'solutions/12_package/arm_player/package.xml').read_text(encoding='utf-8')
    needed = course & set(re.findall(r'depend>([^<]+)</', xml))
    assert needed == course == {'arm_interfaces', 'my_robot_basics'}
    assert all(f'`{package}`' in robot for package in needed)
    for package in course:  # and these need nothing more of the course
        xml = (ROOT / package / 'package.xml').read_text(encoding='utf-8')
        assert not course & set(re.findall(r'depend>([^<]+)</', xml))


@contextmanager
def spun():
    """A node and rclpy's own executor, which spins it until something is true, or time is over."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node, executor = Node('spun', context=context), SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def spin_until(is_true, timeout_sec=10.0):
        end = time.monotonic() + timeout_sec
        while not is_true() and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        return bool(is_true())

    try:
        yield node, spin_until
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)


@contextmanager
def served(watcher, execute, **callbacks):
    server = ActionServer(watcher.node, MoveArm, '/_move', execute, **callbacks)
    client = ActionClient(watcher.node, MoveArm, '/_move')
    assert watcher.spin_until(client.server_is_ready, timeout_sec=10.0)
    yield client
    client.destroy()
    server.destroy()


def answer(watcher, future):
    assert watcher.spin_until(future.done, timeout_sec=10.0)
    return future.result()
