"""No fault is found in correct servers and clients, however long a response takes."""

import threading

import pytest
import rclpy
from diagnosed import TIMEOUT_SEC, wait_for
from my_robot_basics.doctor import report
from my_robot_basics.doctor.diagnosing import diagnose
from my_robot_basics.live import run, stop
from my_robot_basics.session import classroom
from nodes.patient import process
from nodes.patient_services import (
    ASK,
    ASKER,
    DEF_ASK,
    NAME,
    SERVER,
    WORK,
    node_class,
    program,
)
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty
from std_srvs.srv import SetBool

ASYNC = (DEF_ASK, f'async {DEF_ASK}')
AWAIT = (ASK, 'self.receive(await self.client.call_async(request))')
CALL = (ASK, 'self.receive(self.client.call(request))')
THREAD = (
    ASK,
    'import threading; threading.Thread('
    'target=lambda: self.receive(self.client.call(request))).start()',
)
QUEUE = (
    ASK,
    'future = self.client.call_async(request); self.create_timer('
    '0.05, lambda: self.receive(future) if future.done() and not self.answered else None)',
)
CLIENTS = {
    'add_done_callback': ([], None, SingleThreadedExecutor),
    'await': ([ASYNC, AWAIT], ReentrantCallbackGroup, SingleThreadedExecutor),
    'await with threads': ([ASYNC, AWAIT], ReentrantCallbackGroup, MultiThreadedExecutor),
    'call with threads': ([CALL], ReentrantCallbackGroup, lambda: MultiThreadedExecutor(2)),
    'a thread of its own': ([THREAD], None, SingleThreadedExecutor),
    'a queue and a timer': ([QUEUE], None, SingleThreadedExecutor),
}


@pytest.fixture(autouse=True)
def _stop():
    yield
    stop()


class Spun:
    """A node that an executor of its own spins, as its constructor may arrange it."""

    def __init__(self, node, executor):
        self.node, self.executor = node, executor
        executor.add_node(node)
        self.ending = threading.Event()
        self.thread = threading.Thread(target=self.spin)

    def spin(self):
        while not self.ending.is_set():
            self.executor.spin_once(timeout_sec=0.1)

    def __enter__(self):
        self.thread.start()
        return self.node

    def __exit__(self, *_):
        self.ending.set()
        self.thread.join()
        self.node.destroy_node()
        self.executor.shutdown()


@pytest.fixture(scope='module', autouse=True)
def ros():
    run(Node, 'first')  # the first run sets ROS up, whichever test comes first
    stop()


def asker(edits, group, make_executor):
    node = node_class(ASKER, *edits)(group=group() if group else None)
    return Spun(node, make_executor())


def look():
    return diagnose(NAME, domain_id=classroom.enter())


def assert_well():
    (diagnosis,) = look()
    assert not diagnosis.findings, report.tell(diagnosis)
    return report.tell(diagnosis)


@pytest.mark.slow
@pytest.mark.parametrize('work_sec', [0.0, 2.0])
@pytest.mark.parametrize('kind', CLIENTS)
def test_no_fault_is_found_in_a_client_of_a_quick_or_slow_server(kind, work_sec):
    server = run(node_class(SERVER, (WORK, f'time.sleep({work_sec})')))
    with asker(*CLIENTS[kind]) as node:
        assert wait_for(lambda: server.taken)
        assert_well()  # while it waits, if the server is slow
        assert wait_for(lambda: node.answered)
        assert_well()


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['add_done_callback', 'await', 'call with threads'])
def test_no_fault_is_found_in_a_slow_server_of_another_process(kind):
    with process(program(SERVER, (WORK, 'time.sleep(2.0)'))), asker(*CLIENTS[kind]) as node:
        assert wait_for(lambda: node.timer.is_canceled())
        assert_well()
        assert wait_for(lambda: node.answered)


SERVERS = {
    'awaits': ('def answer', 'async def answer'),
    'in groups': ('self.answer)', 'self.answer, callback_group=ReentrantCallbackGroup())'),
    'serves two': (
        'self.answer)',
        "self.answer); self.create_service(SetBool, '/open_gripper', self.answer)",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize('kind', SERVERS)
def test_no_fault_is_found_in_a_correct_server(kind):
    run(node_class(SERVER, SERVERS[kind]))
    node = run(node_class(ASKER))
    assert wait_for(lambda: node.answered)
    assert_well()


@pytest.mark.slow
def test_no_fault_is_found_in_a_server_without_clients():
    run(node_class(SERVER))
    assert '/server serves, nobody asks' in assert_well()


@pytest.mark.slow
def test_no_fault_is_found_in_nodes_without_parameter_services():
    bare = ('**kwargs)\n', 'start_parameter_services=False)\n')
    with process(program(SERVER, bare)), asker(*CLIENTS['await']) as node:
        assert wait_for(lambda: node.answered)
        assert_well()


@pytest.mark.slow
def test_no_fault_is_found_in_a_server_with_endless_requests():
    run(node_class(SERVER, (WORK, 'time.sleep(0.3)')))
    ask = 'self.timer.reset(); self.client.call_async(request)'
    run(node_class(ASKER, (ASK, ask)))
    assert_well()


@pytest.mark.slow
def test_no_fault_is_found_if_a_node_is_spun_only_for_its_requests():
    run(node_class(SERVER))
    user = Node('user')
    client = user.create_client(SetBool, NAME)
    assert client.wait_for_service(timeout_sec=TIMEOUT_SEC)
    rclpy.spin_until_future_complete(user, client.call_async(SetBool.Request()))
    assert_well()
    user.destroy_node()


@pytest.mark.slow
def test_a_lost_request_is_mentioned_but_is_no_fault():
    user = run(Node, 'user')
    client = user.create_client(SetBool, NAME)
    lost = client.call_async(SetBool.Request())
    run(node_class(SERVER))
    assert client.wait_for_service(timeout_sec=TIMEOUT_SEC)
    assert client.call(SetBool.Request()) is not None
    told = assert_well()
    assert not lost.done()
    assert 'one of /user has no response' in told
    assert 'service_is_ready()' in told
    client.remove_pending_request(lost)
    assert 'no response' not in assert_well()


@pytest.mark.slow
def test_services_of_similar_names_with_their_own_clients_are_no_fault():
    for side in 'left', 'right':
        run(node_class(SERVER, (NAME, f'/{side}{NAME}'), ("'server'", f"'{side}'")), key=side)
        run(
            node_class(ASKER, (NAME, f'/{side}{NAME}'), ("'asker'", f"'of_{side}'")),
            key=f'of_{side}',
        )
    run(node_class(SERVER))
    assert_well()


@pytest.mark.slow
def test_a_topic_and_a_service_of_one_name_are_both_diagnosed():
    server = run(node_class(SERVER))
    publisher = server.create_publisher(Empty, NAME, 10)
    server.create_timer(0.1, lambda: publisher.publish(Empty()))
    topic, service = look()
    assert [each.title for each in topic.findings] == ['no subscription']
    assert service.findings == ()
