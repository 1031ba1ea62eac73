"""The verbs that run until they are stopped: echo, hz, bw and pub."""

import os
import re
import select
import signal
import subprocess
import time

import pytest
from rclpy.context import Context
from rclpy.node import Node
from ros2_command import SCRIPT, TIMEOUT_SEC, on_the_graph, own_domain, ros2, started

TOPIC = '/kinematics/joint_states'
NUMBER = r'-?\d+\.\d+(e-\d+)?'


@pytest.fixture(scope='module', autouse=True)
def system():
    with own_domain(), on_the_graph('everything', 'five_hz', topics=('/everything_is_up', TOPIC)):
        yield


ECHO = rf"""header:
  stamp:
    sec: \d+
    nanosec: \d+
  frame_id: base_link
name:
- joint1
- joint2
position:
- {NUMBER}
- {NUMBER}
velocity: \[\]
effort: \[\]
---
"""
INFO = r"""publication_sequence_number: \d+
received_timestamp: \d+
reception_sequence_number: null
source_timestamp: \d+

---
"""
PRINTED = [
    ((TOPIC,), ECHO),
    ((TOPIC, 'sensor_msgs/msg/JointState', '--no-daemon', '-s'), ECHO),
    ((TOPIC, '--include-message-info'), INFO.replace('\n\n', '\n') + ECHO),
    ((TOPIC, '--qos-reliability', 'best_effort', '--qos-depth', '1'), ECHO),
    ((TOPIC, '--csv'), rf'\d+,\d+,base_link,joint1,joint2,{NUMBER},{NUMBER},,\n'),
    ((TOPIC, '--csv', '-i'), rf'(\d+,){{3}}None,\d+,\d+,base_link,joint1,joint2,{NUMBER},.*\n'),
    ((TOPIC, '--field', 'header.stamp'), r'sec: \d+\nnanosec: \d+\n---\n'),
    ((TOPIC, '--field', 'position'), rf"array\('d', \[{NUMBER}, {NUMBER}\]\)\n---\n"),
    ((TOPIC, '--field', 'name', '-i'), r'---Got new message, message info:---\n{.*}\n'
     r"---Message data:---\n\['joint1', 'joint2'\]\n---\n"),
    ((TOPIC, '--raw'), r"""b(['"]).*base_link.*\1\n---\n"""),
    ((TOPIC, '--field', 'header', '--flow-style', '--no-str'),
     r"stamp:\n  sec: \d+\n  nanosec: \d+\nframe_id: '<string length: <9>>'\n---\n"),
    ((TOPIC, '--field', 'name', '--filter', 'len(m) == 2'), r"\['joint1', 'joint2'\]\n---\n"),
    (('/arm_description',), r'data: two links\n---\n'),  # latched: echo adapts its QoS
    (('/arm_description', '-l', '3'), r'data: two...\n---\n'),
    (('/arm_description', '--qos-reliability', 'reliable', '--qos-durability',
      'transient_local', '--qos-depth', '1'), r'data: two links\n---\n'),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'expected'), PRINTED, ids=[' '.join(p[0]) for p in PRINTED])
def test_echo_prints_the_output_of_ros2cli(words, expected):
    result = ros2('topic', 'echo', '--once', *words)
    assert re.fullmatch(expected, result.out), result.out
    assert (result.err, result.status) == ('', 0)


UNPUBLISHED = 'WARNING: topic [/nothing] does not appear to be published yet\n'
REFUSED = [
    ('echo /nothing', UNPUBLISHED, 'Could not determine the type for the passed topic\n'),
    (f'echo {TOPIC} std_msgs/msg/Nothing', '', 'The passed message type is invalid\n'),
    (f'echo {TOPIC} --field .', '', "Invalid field value '.'\n"),
    (f'echo {TOPIC} --field header.sec', '',
     "Invalid field 'header.sec': 'Header' object has no attribute 'sec'\n"),
    (f'echo {TOPIC} --filter m.', '',
     "--filter: not Python: 'm.' (invalid syntax (--filter, line 1))\n"),
    (f'hz {TOPIC} --filter m.x', '', "--filter: 'm.x' failed on a message: AttributeError: "
     "'JointState' object has no attribute 'x'\n"),
    ('bw //x', '', 'Invalid topic name: topic name must not contain repeated \'/\':\n'
     "  '//x'\n    ^\n"),
    ('pub /x std_msgs/msg/Strin', '',
     'The passed message type is invalid: did you mean std_msgs/msg/String?\n'),
    ('pub /x std_msgs/msg/String [1]', '',
     'The passed value needs to be a dictionary in YAML format\n'),
    ('pub /x std_msgs/msg/String {data}:', '',
     'The passed value is not YAML: while constructing a mapping\n'),
    ('pub /x std_msgs/msg/String {date:1}', '', 'Failed to populate field: date:1: std_msgs/msg/'
     "String has no field 'date:1': did you mean data?\n"),
    ('pub /x std_msgs/msg/String --max-wait-time-secs 1', '', '--max-wait-time-secs option is '
     'only effective with --wait-matching-subscriptions, --once or --times\n'),
    ('pub /x std_msgs/msg/String -1 --max-wait-time-secs 0.2',
     'Waiting for at least 1 matching subscription(s)...\n',
     'Timed out waiting for subscribers: Expected 1 subcribers but only got 0 subscribers\n'),
    ('pub /x std_msgs/msg/String -n a-b', '', 'Invalid node name: '),
]  # fmt: skip


@pytest.mark.parametrize(('words', 'out', 'err'), REFUSED, ids=[words for words, *_ in REFUSED])
def test_invalid_topic_arguments_are_refused_in_a_sentence(words, out, err):
    result = ros2('topic', *words.split())
    assert (result.out, result.status) == (out, 1)
    assert result.err.startswith(err)
    assert 'Traceback' not in result.err


@pytest.mark.slow
def test_echo_falls_back_to_best_effort_for_mixed_publishers():
    with on_the_graph('best_effort', topics=()):
        said = ''
        while 'Some' not in said:  # until it is up
            said = ros2('topic', 'echo', '--once', TOPIC).out
    assert said.startswith(
        'Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back '
        'to QoSReliabilityPolicy.BEST_EFFORT as it will connect to all publishers\nheader:\n'
    )


def test_echo_gives_up_after_its_timeout():
    result = ros2('topic', 'echo', '/heard', '--timeout', '0.1')
    assert (result.out, result.err, result.status) == ('', '', 0)


RATE = (
    r'average rate: (\d+\.\d{3})\n'
    r'\tmin: \d\.\d{3}s max: \d\.\d{3}s std dev: \d\.\d{5}s window: (\d+)\n'
)
BANDWIDTH = r'(\d+) B/s from (\d+) messages\n\tMessage size mean: 95 B min: 95 B max: 95 B\n'


def test_hz_prints_the_rate():
    with started(SCRIPT, 'topic', 'hz', TOPIC, '--window', '3') as hz:
        rate = 0.0
        while not 4.0 < rate < 6.0:  # of 5 Hz: a busy machine delays messages, but not always
            text = hz.stdout.readline() + hz.stdout.readline()
            rate, window = map(float, re.fullmatch(RATE, text).groups())
            assert window == 3


def test_bw_prints_the_bandwidth():
    with started(SCRIPT, 'topic', 'bw', TOPIC) as bw:
        assert bw.stdout.readline() == f'Subscribed to [{TOPIC}]\n'
        text = bw.stdout.readline() + bw.stdout.readline()
    assert re.fullmatch(BANDWIDTH.replace('95', r'\d+'), text), text


@pytest.mark.slow
@pytest.mark.parametrize('verb', ['hz', 'bw'])
def test_hz_and_bw_wait_for_a_publisher(verb):
    warning = 'WARNING: topic [/later] does not appear to be published yet\n'
    with started(SCRIPT, 'topic', verb, '/later') as measuring:
        assert measuring.stdout.readline() == warning
        with started(SCRIPT, 'topic', 'pub', '-r', '20', '/later', 'std_msgs/msg/String'):
            line = measuring.stdout.readline()
    assert line.startswith('average rate: ' if verb == 'hz' else 'Subscribed to [/later]')


def test_pub_reaches_echo():
    with started(SCRIPT, 'topic', 'echo', '/chat', 'std_msgs/msg/String') as echo:
        once = ros2('topic', 'pub', '--once', '/chat', 'std_msgs/msg/String', '{data: hé}')
        more = ros2(
            *('topic', 'pub', '-t', '3', '-r', '20', '-p', '2', '-w', '1', '/chat'),
            *('std_msgs/String', '--stdin'),
            stdin='data: "1"',
        )
        heard = [echo.stdout.readline() for _ in range(8)]
    assert heard == ['data: hé\n', '---\n', *["data: '1'\n", '---\n'] * 3]
    waiting = r'(Waiting for at least 1 matching subscription\(s\)\.\.\.\n)+'
    started_once, started_more = (re.sub(f'^{waiting}', '', r.out) for r in (once, more))
    assert started_once == (
        "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='hé')\n\n"
    )
    assert started_more == (
        "publisher: beginning loop\npublishing #2: std_msgs.msg.String(data='1')\n\n"
    )
    assert (once.err, once.status, more.err, more.status) == ('', 0, '', 0)


def test_pub_stamps_messages_when_it_publishes_them():
    pub = 'topic', 'pub', '-r', '20', '/stamped', 'geometry_msgs/msg/PointStamped', 'header: auto'
    with started(SCRIPT, *pub) as publisher:
        lines = [publisher.stdout.readline() for _ in range(5)]
    first, second = (re.search(r'sec=(\d+), nanosec=(\d+)', lines[n]).groups() for n in (1, 3))
    assert int(first[0]) > 0
    assert first != second


ENDLESS = {
    'echo': ('echo', TOPIC),
    'echo of a silent topic': ('echo', '/heard'),
    'hz': ('hz', TOPIC),
    'hz of no topic': ('hz', '/nothing'),
    'bw': ('bw', TOPIC),
    'pub': ('pub', '/x', 'std_msgs/msg/String'),
    'pub that waits': ('pub', '--once', '/x', 'std_msgs/msg/String'),
    'pub that lingers': (
        'pub',
        '--once',
        '-w',
        '0',
        '--keep-alive',
        '99',
        '/x',
        'std_msgs/String',
    ),
}
endless = pytest.mark.parametrize('words', ENDLESS.values(), ids=ENDLESS)


def wait_for_handlers(process):
    """Wait until the command handles signals: before, Python is still starting."""
    term = 1 << (signal.SIGTERM - 1)
    while True:
        with open(f'/proc/{process.pid}/status', encoding='ascii') as status:
            caught = next(line for line in status if line.startswith('SigCgt'))
        if int(caught.split()[1], 16) & term:
            return


@endless
def test_a_signal_ends_an_endless_verb_silently_with_the_status_of_ros2cli(words):
    number = (signal.SIGINT, signal.SIGTERM)[len(words) % 2]
    with started(SCRIPT, 'topic', *words) as process:
        wait_for_handlers(process)
        # somewhere in the imports, in discovery, or in the work
        select.select([process.stdout], [], [], len(words[-1]) % 10 / 10)
        process.send_signal(number)
        _, err = process.communicate(timeout=TIMEOUT_SEC)
    assert (process.returncode, err) == (number, '')


@pytest.fixture
def bystander():
    """A node that stays on the graph; it would still see a killed node for seconds."""
    context = Context()
    context.init(domain_id=int(os.environ['ROS_DOMAIN_ID']))
    node = Node('bystander', context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_echo_ended_by_a_signal_at_any_moment_leaves_no_node_on_the_graph(number, bystander):
    for moment_sec in (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8):
        with started(SCRIPT, 'topic', 'echo', '/heard') as process:
            wait_for_handlers(process)
            time.sleep(moment_sec)
            process.send_signal(number)
            out, err = process.communicate(timeout=TIMEOUT_SEC)
        assert (process.returncode, out, err) == (number, '', '')
        time.sleep(0.2)  # the news that it has left is under way
        names = bystander.get_node_names()
        assert not [name for name in names if name.startswith('_ros2cli_')]


@endless
def test_an_endless_verb_ends_when_its_output_is_closed(words):
    with started(SCRIPT, 'topic', *words) as process:
        process.stdout.close()
        assert process.stderr.read() == ''
        assert process.wait(TIMEOUT_SEC) == 141


def test_head_receives_its_lines_of_echo():
    # with its type it waits for a publisher: without, a busy machine may show none in time;
    # `timeout` ends it then: its node would be in the way of the tests that follow
    echo = f'"{SCRIPT}" topic echo {TOPIC} sensor_msgs/msg/JointState'
    done = subprocess.run(
        f'timeout {TIMEOUT_SEC} {echo} | head -3',
        shell=True,
        capture_output=True,
        encoding='utf-8',
    )
    assert re.fullmatch(r'header:\n  stamp:\n    sec: \d+\n', done.stdout)
    assert done.stderr == ''


@pytest.mark.slow
def test_a_reader_that_stalls_does_not_hold_up_a_signal():
    more_than_a_pipe_holds = f'data: {"x" * 100_000}'
    pub = 'topic', 'pub', '/x', 'std_msgs/msg/String', more_than_a_pipe_holds
    with started(SCRIPT, *pub) as process:
        select.select([process.stdout], [], [])
        time.sleep(0.3)  # it writes, and nobody reads
        process.send_signal(signal.SIGINT)
        assert process.wait(TIMEOUT_SEC) == signal.SIGINT
