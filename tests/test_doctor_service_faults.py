"""Each planted fault of a service is reported first; a fix of one line, if any, works."""

import contextlib
import re
import shlex
import threading

import pytest
from diagnosed import TIMEOUT_SEC, wait_for, wait_for_finding
from my_robot_basics.doctor import inside
from my_robot_basics.doctor.diagnosing import diagnose
from my_robot_basics.live import run, stop
from my_robot_basics.live.output import troubles
from my_robot_basics.session import classroom, domain
from my_robot_basics.session.neighbours import nodes_here
from nodes.patient import process
from nodes.patient_services import (
    ASK,
    ASKER,
    CLIENT,
    DEF_ASK,
    IF_READY,
    IN_GROUP,
    NAME,
    RETURN,
    SERVER,
    SERVICE,
    SPIN,
    WORK,
    node_class,
    program,
)
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

DEAD = 'while rclpy.ok(): time.sleep(0.1)'
CALL = 'self.client.call(request, timeout_sec=30.0)'
SPIN_HERE = (
    'rclpy.spin_until_future_complete(self, self.client.call_async(request), timeout_sec=30.0)'
)
ASYNC = (DEF_ASK, f'async {DEF_ASK}')
AWAIT = 'await self.client.call_async(request)'
POLL = (
    'future = self.client.call_async(request)\n'
    '            while not future.done() and rclpy.ok(): time.sleep(0.05)'
)


@pytest.fixture(autouse=True)
def _stop():
    yield
    for client in [client for node in nodes_here() for client in node.clients]:
        for future in [*client._pending_requests.values()]:
            future.set_result(None)  # or the callbacks that wait would outlive their nodes
    stop()


def findings(name=NAME, **options):
    (diagnosis,) = diagnose(
        name, domain_id=classroom.enter(), raised=troubles.last_raised_in_service, **options
    )
    return diagnosis.findings


def first_finding(name=NAME, **options):
    found = findings(name, **options)
    assert found, 'nothing was found'
    return found[0]


def assert_well(asker):
    assert wait_for(lambda: asker.answered)
    assert findings() == ()


def start(asker_edits, **options):
    """Start a server, and a client that begins to wait; return the client."""
    run(node_class(SERVER))
    asker = run(node_class(ASKER, *asker_edits), **options)
    assert wait_for(lambda: asker.timer.is_canceled())
    return asker


NAMES = {
    # what is planted: the node's source, the line, what stands there instead, the title
    'server misspelt': (SERVER, SERVICE, '/close_griper', 'the spelling differs'),
    'client misspelt': (ASKER, IN_GROUP, '/close_griper', 'the spelling differs'),
    'case': (SERVER, SERVICE, '/Close_Gripper', 'upper and lower case differ'),
    'namespace': (SERVER, SERVICE, '/left/close_gripper', 'the namespace differs'),
}


@pytest.mark.slow
@pytest.mark.parametrize('fault', NAMES)
def test_a_wrong_service_name_is_reported_first_and_fixed(fault):
    source, line, name, title = NAMES[fault]
    edits = {SERVER: [], ASKER: []}
    edits[source] = [(line, line.replace(NAME, name))]
    run(node_class(SERVER, *edits[SERVER]))
    run(node_class(ASKER, *edits[ASKER]))
    found = first_finding()
    assert title in found.title
    run(node_class(SERVER, *([(SERVICE, found.code)] if source is SERVER else [])))
    assert_well(run(node_class(ASKER, *([(line, found.code)] if source is ASKER else []))))


@pytest.mark.slow
@pytest.mark.parametrize('asked', [NAME, f'/left{NAME}'])
def test_a_relative_name_is_reported_in_the_node_that_uses_it(asked):
    run(node_class(SERVER))
    relative = (IN_GROUP, IN_GROUP.replace(NAME, NAME[1:]))
    run(node_class(ASKER, relative), namespace='/left')
    found = first_finding(asked)
    assert "in /left/asker, a name without a leading / begins with the node's namespace" in (
        found.seen
    )
    asker = run(node_class(ASKER, (IN_GROUP, found.code)), namespace='/left')
    assert_well(asker)


@pytest.mark.slow
def test_a_client_without_a_server_is_reported_and_the_fix_works():
    run(node_class(ASKER))
    found = first_finding()
    assert found.title == 'no server'
    assert '/asker asks it' in found.seen
    run(node_class(SERVER, (SERVICE, found.code)))
    assert wait_for(lambda: findings() == ())


@pytest.mark.slow
def test_two_types_of_a_service_are_reported_and_the_fix_works():
    # in one process rclpy itself refuses the second one
    run(node_class(ASKER, (IN_GROUP, CLIENT.replace('SetBool', 'Trigger'))))
    with process(program(SERVER)):
        found = wait_for_finding(first_finding, 'types differ')
        assert '/server serves std_srvs/srv/SetBool' in found.seen
        assert_well(run(node_class(ASKER, (IN_GROUP, found.code))))


DEADLOCKS = {
    'call': ([(ASK, CALL)], 'its executor has one thread'),
    'spin in a callback': ([(ASK, SPIN_HERE)], 'the client is in the same callback group'),
    'await in the default group': ([ASYNC, (ASK, AWAIT)], 'the client is in the same callback'),
    'call when a future is done': (
        [('self.answered += 1', CALL.replace('request', 'SetBool.Request()'))],
        'its executor has one thread',
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize('fault', DEADLOCKS)
def test_a_client_that_blocks_its_executor_is_reported_and_fixed(fault):
    edits, why = DEADLOCKS[fault]
    asker = start(edits)
    assert wait_for(lambda: asker.client._pending_requests)
    found = first_finding()
    assert 'deadlock' in found.title
    name = 'receive' if 'done' in fault else 'ask'
    assert f'the callback {name} of /asker to return' in found.expected
    assert NAME in found.seen
    assert why in found.seen
    assert not asker.answered
    assert not any('not spinning' in each.title for each in findings())
    assert_well(start([(ASK, found.code)]))


@contextlib.contextmanager
def spun(node, executor):
    """Let an executor spin a node in a thread of its own."""
    executor.add_node(node)
    ending = threading.Event()

    def spin():
        while not ending.is_set():
            executor.spin_once(timeout_sec=0.1)

    thread = threading.Thread(target=spin)
    thread.start()
    try:
        yield
    finally:
        ending.set()
        for future in [*node.client._pending_requests.values()]:
            future.set_result(None)
        thread.join()
        node.destroy_node()
        executor.shutdown()


@pytest.mark.slow
@pytest.mark.parametrize(
    ('group', 'threads', 'why'),
    [
        (MutuallyExclusiveCallbackGroup, 2, 'the client is in the same callback group'),
        (ReentrantCallbackGroup, 1, 'all threads of its executor wait like this'),
        (ReentrantCallbackGroup, 2, None),
    ],
)
@pytest.mark.filterwarnings('ignore:MultiThreadedExecutor is used with a single thread')
def test_a_call_with_threads_is_reported_only_if_no_thread_can_take_the_response(
    group, threads, why
):
    run(node_class(SERVER, (WORK, 'time.sleep(1.5)')))
    asker = node_class(ASKER, (ASK, CALL))(group=group())
    with spun(asker, MultiThreadedExecutor(threads)):
        assert wait_for(lambda: asker.client._pending_requests)
        found = findings()
    assert [each.title for each in found] == (
        ['a callback waits for its own executor (deadlock)'] if why else []
    )
    assert why is None or why in found[0].seen


@pytest.mark.slow
def test_a_server_that_calls_itself_is_reported():
    other = '/open_gripper'
    asks = f"self.create_client(SetBool, '{other}').call(request, timeout_sec=30.0)"
    serves = f"{SERVICE}; self.create_service(SetBool, '{other}', self.answer)"
    run(node_class(SERVER, (SERVICE, serves), (WORK, asks)))
    run(node_class(ASKER))
    assert wait_for(lambda: inside_callbacks('answer'))
    found = first_finding()
    assert 'the callback answer of /server to return' in found.expected
    assert other in found.seen


def inside_callbacks(name):
    view = inside.Inside()
    view.look()
    return [each for each in view.callbacks(at_least_sec=0.0) if each.name == name]


@pytest.mark.slow
def test_a_callback_that_polls_for_its_response_is_reported_and_fixed():
    asker = start([(ASK, POLL)])
    found = first_finding()
    assert found.title == 'a callback has not returned'
    assert f"until it returns, the response of {NAME} can't be taken" in found.seen
    assert not asker.answered
    assert_well(start([(ASK, found.code)]))


@pytest.mark.slow
def test_a_callback_that_waits_for_an_absent_server_is_reported_and_fixed():
    run(node_class(ASKER, (IF_READY, 'if self.client.wait_for_service(30.0):')))
    assert wait_for(lambda: inside_callbacks('ask'))
    first, second = findings()
    assert first.title == 'no server'
    assert second.title == 'a callback waits for the server'
    assert 'it has waited in wait_for_service (line ' in second.seen
    asker = run(node_class(ASKER, (IF_READY, second.code)))
    run(node_class(SERVER))
    assert_well(asker)


@pytest.mark.slow
def test_a_server_that_returns_no_response_is_reported_and_fixed():
    run(node_class(SERVER, (RETURN, 'pass')))
    run(node_class(ASKER))
    assert wait_for(lambda: troubles.last_raised_in_service(NAME))
    found = first_finding()
    assert found.title == 'the callback returned no response'
    run(node_class(SERVER, (RETURN, found.code)))
    assert_well(run(node_class(ASKER)))


@pytest.mark.slow
def test_a_server_that_raises_is_reported_with_its_exception():
    run(node_class(SERVER, (WORK, "raise ValueError('it is jammed')")))
    run(node_class(ASKER))
    assert wait_for(lambda: troubles.last_raised_in_service(NAME))
    found = first_finding()
    assert found.title == 'the callback raised'
    assert 'ValueError: it is jammed' in found.seen
    run(node_class(SERVER))
    assert_well(run(node_class(ASKER)))


@pytest.mark.slow
def test_an_exception_of_a_timer_is_not_attributed_to_the_service():
    run(node_class(SERVER, (SERVICE, f'{SERVICE}; self.create_timer(0.1, lambda: 1 / 0)')))
    asker = run(node_class(ASKER))
    assert wait_for(lambda: troubles.last_raised('/server'))
    assert_well(asker)


@pytest.mark.slow
def test_a_server_whose_callback_does_not_return_is_reported():
    server = run(node_class(SERVER, (WORK, 'while rclpy.ok() and self.taken: time.sleep(0.05)')))
    asker = run(node_class(ASKER))
    assert wait_for(lambda: server.taken)
    found = first_finding()
    assert found.title == 'a callback has not returned'
    assert 'the callback answer of /server to return, so that its response is sent' in (
        found.expected
    )
    assert 'line ' in found.seen
    server.taken = 0
    assert_well(asker)


@pytest.mark.slow
def test_a_server_that_is_not_spun_is_reported():
    server = node_class(SERVER)()
    asker = run(node_class(ASKER))
    assert wait_for(lambda: asker.timer.is_canceled())
    found = first_finding()
    assert found.title == 'the node is not spinning'
    assert 'no thread spins it' in found.seen
    server.destroy_node()
    run(node_class(SERVER))
    assert_well(run(node_class(ASKER)))


@pytest.mark.slow
def test_a_server_that_is_not_spun_in_another_process_is_reported_and_fixed():
    with process(program(SERVER, (SPIN, DEAD))):
        assert wait_for(has_server)
        found = first_finding()
        assert found.title == 'the node answers nothing'
        assert re.search(r'answered nothing for at least \d+ s', found.seen)
    with process(program(SERVER, (SPIN, found.code))):
        assert_well(run(node_class(ASKER)))


def has_server():
    node = Node('looks')
    try:
        return node.create_client(SetBool, NAME).wait_for_service(timeout_sec=1.0)
    finally:
        node.destroy_node()


@pytest.mark.slow
def test_a_client_that_is_not_spun_is_reported_once_it_waits():
    run(node_class(SERVER))
    user = Node('user')
    client = user.create_client(SetBool, NAME)
    assert client.wait_for_service(timeout_sec=TIMEOUT_SEC)
    assert findings() == ()  # it may be spun later, when it asks
    client.call_async(SetBool.Request())
    found = first_finding()
    user.destroy_node()
    assert found.title == 'the node is not spinning'
    assert 'so that responses are taken' in found.expected


@pytest.mark.slow
def test_a_client_whose_node_was_taken_from_its_executor_is_reported():
    asker = start([(ASK, SPIN_HERE.replace('30.0', '0.5'))])
    assert wait_for(lambda: asker not in asker.executor.get_nodes())
    found = first_finding()
    assert found.title == 'the node is not spinning'
    assert 'spin_until_future_complete' in found.seen


@pytest.mark.slow
def test_a_remapped_server_is_reported_and_its_fix_works():
    run(node_class(ASKER))
    command = program(SERVER, ('rclpy.init()', 'import sys; rclpy.init(args=sys.argv)'))
    with process([*command, '--ros-args', '-r', f'{NAME}:=/elsewhere']):
        found = wait_for_finding(first_finding, 'remapped')
    with process(shlex.split(found.code.removeprefix('$ '))):
        assert_well(run(node_class(ASKER)))


@pytest.mark.slow
def test_two_servers_of_one_name_are_reported_as_several_servers():
    run(node_class(SERVER))
    second = run(Node, 'second')
    worked = []
    second.create_service(SetBool, NAME, lambda request, response: worked.append(1) or response)
    asker = run(node_class(ASKER))
    assert wait_for(lambda: asker.answered and worked)
    finding = first_finding()
    assert finding.title == 'several servers'
    assert '/second' in finding.seen


@pytest.mark.slow
def test_a_server_in_another_domain_is_reported():
    claim = domain.claim()
    name = f'{NAME}_{claim.domain_id}'  # tests beside this one have servers, too
    run(node_class(ASKER, (IN_GROUP, IN_GROUP.replace(NAME, name))))
    context = Context()
    context.init(domain_id=claim.domain_id)
    server = node_class(SERVER, (SERVICE, SERVICE.replace(NAME, name)))(context=context)
    found = first_finding(name, other_domains=True)
    server.destroy_node()
    context.try_shutdown()
    claim.release()
    assert found.title == 'another domain ID'
    assert f'/server serves there in domain {claim.domain_id}' in found.seen
