"""What a rule says of evidence, without a graph; and the QoS rule against what really arrives."""

import dataclasses
import html
import re
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from my_robot_basics.doctor import as_html, picture, remaps, report, rules, service_rules
from my_robot_basics.doctor.callback import Callback
from my_robot_basics.doctor.evidence import Endpoint, Evidence, NodeState, ReceivedMessage
from my_robot_basics.doctor.remaps import of_command
from my_robot_basics.doctor.rules import judge, qos
from my_robot_basics.doctor.service_evidence import ServiceEvidence, Unanswered
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import String

TOPIC = '/kinematics/joint_states'
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
def test_the_diagnosis_agrees_with_what_arrives(both_ends, offered, asked):
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
        gaps = qos.incompatible(offer.qos_profile, wish.qos_profile)

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
def test_the_fix_of_any_profile_is_content_with_the_offer(offered, asked):
    given_, wanted = infinite(QoSProfile(**offered)), infinite(QoSProfile(**asked))
    gaps = qos.incompatible(given_, wanted)
    if gaps:
        fixed = eval(qos._compatible_profile(given_, wanted), {**globals()})
        assert qos.incompatible(given_, infinite(fixed)) == {}


def infinite(profile):
    """As the graph tells it: a duration that was left out has no end."""
    for name in 'deadline', 'liveliness_lease_duration':
        if getattr(profile, name).nanoseconds == 0:
            setattr(profile, name, Duration(nanoseconds=2**63 - 1))
    return profile


def end(kind, node_name, *, topic_name=TOPIC, type_name='sensor_msgs/msg/JointState', depth=None):
    return Endpoint(
        kind=kind,
        node_name=node_name,
        name=topic_name,
        type_name=type_name,
        qos_profile=infinite(QoSProfile(depth=depth or 10)),
        depth=depth,
    )


def healthy(*, rate_hz=5.0, number=10, position=(0.4, -1.1), names=('joint1', 'joint2')):
    start_sec = time.time()
    received = []
    for i in range(number):
        message = JointState(name=list(names), position=list(position))
        sent_sec = start_sec + i / rate_hz
        message.header.stamp.sec = int(sent_sec)
        message.header.stamp.nanosec = int(sent_sec % 1 * 1e9)
        received.append(ReceivedMessage(message=message, sent_sec=sent_sec))
    return Evidence(
        name=TOPIC,
        endpoints=(end('publisher', '/talker'), end('subscription', '/listener')),
        nodes={'/talker': NodeState(answers=True), '/listener': NodeState(answers=True)},
        received=tuple(received),
        listened_sec=number / rate_hz,
        start_sec=start_sec,
    )


@pytest.mark.parametrize(
    'evidence',
    [
        healthy(),
        healthy(rate_hz=900.0, number=2000),
        healthy(number=1),
        healthy(rate_hz=0.3, number=2),
        healthy(position=(50.0, 3.0), names=('left_wheel', 'arm')),
        healthy(position=(5e5, 3.0)),
        healthy(position=(float('nan'), float('inf'))),
    ],
)
def test_a_healthy_topic_is_not_accused(evidence):
    assert judge(evidence).findings == ()


def replaced(evidence=None, **changes):
    return dataclasses.replace(evidence or healthy(), **changes)


TALKER, LISTENER = healthy().endpoints
SILENT = {'received': (), 'listened_sec': 6.0}


@pytest.mark.parametrize(
    ('evidence', 'titles'),
    [
        (replaced(endpoints=(), received=(), nodes={}), ['no publisher', 'no subscription']),
        (replaced(endpoints=(TALKER,)), ['no subscription']),
        (replaced(**SILENT), ['the timer never fires']),
        (
            replaced(endpoints=(LISTENER,), missing_participants=1, **SILENT),
            ['a process that cannot be discovered', 'no publisher'],
        ),
        (replaced(missing_participants=1), []),
        (
            replaced(
                endpoints=(
                    end('publisher', '/lidar', type_name='velodyne_msgs/msg/VelodyneScan'),
                    end('subscription', '/driver', type_name='velodyne_msgs/msg/VelodyneScan'),
                ),
                unknown_types=('velodyne_msgs/msg/VelodyneScan',),
                received=(),
                listened_sec=0.0,
            ),
            ['message type not installed here'],
        ),
        (
            replaced(endpoints=(LISTENER,), elsewhere={7: (TALKER,)}, **SILENT),
            ['another domain ID', 'no publisher'],
        ),
        (
            replaced(endpoints=(end('publisher', '/talker', topic_name='/joint_states'),)),
            ['a similar name: the namespace differs', 'no publisher', 'no subscription'],
        ),
        (
            replaced(nodes={'/listener': NodeState(answers=False)}),
            ['the node is not spinning'],
        ),
        (replaced(nodes={'/talker': NodeState(answers=False)}), []),
        (
            replaced(nodes={'/talker': NodeState(answers=False)}, **SILENT),
            ['the node is not spinning'],
        ),
        (
            replaced(nodes={'/talker': NodeState(answers=True, use_sim_time=True)}, **SILENT),
            ['use_sim_time without a /clock'],
        ),
        (
            replaced(
                nodes={'/talker': NodeState(answers=True, use_sim_time=True)},
                has_clock=True,
                **SILENT,
            ),
            ['the timer never fires'],
        ),
    ],
)
def test_what_follows_from_what_was_seen(evidence, titles):
    assert [finding.title for finding in judge(evidence).findings] == titles


def with_bursts(*firsts, number=6):
    """100 Hz from a queue of one, in which `number` messages each came at once."""
    evidence = healthy(rate_hz=100.0, number=200)
    received = list(evidence.received)
    for first in firsts:
        for i in range(first, first + number):
            received[i] = dataclasses.replace(
                received[i], sent_sec=received[first + number - 1].sent_sec
            )
    ends = end('publisher', '/talker', depth=1), end('subscription', '/listener')
    return replaced(evidence, received=tuple(received), endpoints=ends)


@pytest.mark.parametrize(
    ('evidence', 'titles'),
    [
        (with_bursts(50), []),  # a machine that stood still for a moment
        (with_bursts(50, 120), []),
        (with_bursts(*range(0, 180, 10)), ['messages lost to a short queue']),
    ],
)
def test_who_sends_in_bursts_does_it_again_and_again(evidence, titles):
    assert [finding.title for finding in judge(evidence).findings] == titles


def test_the_waiting_one_of_two_similar_names_is_meant():
    met = '/kinematics/joint_statez'
    ends = (
        LISTENER,
        end('publisher', '/busy', topic_name=met),
        end('subscription', '/its_listener', topic_name=met),
        end('publisher', '/lonely', topic_name='/kinematics/joint_stats'),
    )
    first = judge(replaced(endpoints=ends, **SILENT)).findings[0]
    assert first.broken[0].node_name == '/lonely'


def test_a_misspelt_question_is_answered_with_the_right_one():
    asked = replaced(name='/kinematic/joint_state', **SILENT)
    first = judge(asked).findings[0]
    assert first.code == f'$ topic_doctor {TOPIC}'


def test_an_empty_domain_sends_to_the_others():
    empty = replaced(endpoints=(), nodes={}, **SILENT)
    assert '--domains' in judge(empty).findings[0].fix
    looked = replaced(empty, elsewhere={7: (LISTENER,)})
    assert not any('--domains' in finding.fix for finding in judge(looked).findings)


@pytest.mark.parametrize('table', [rules, service_rules], ids=lambda table: table.__name__)
def test_every_rule_is_in_its_table(table):
    from importlib import resources

    folder = resources.files(table)
    files = {f.name.removesuffix('.py') for f in folder.iterdir() if f.name.endswith('.py')}
    tabled = [rule.__module__.rpartition('.') for rule in table.RULES]
    assert {name for package, _, name in tabled if package == table.__name__} == (
        files - {'__init__'}
    )


@pytest.mark.parametrize(
    ('words', 'rules'),
    [
        (['node', '--ros-args', '-r', 'a:=/b'], [('node --ros-args', '/a', '/b')]),
        (['node', '-r', '/a:=/b'], []),
        (['node', '--ros-args', '-p', 'x:=1'], []),
        (['node', '--ros-args', '-r'], []),
    ],
)
def test_remapping_rules_are_read_from_command_lines(words, rules):
    found = of_command(words)
    assert [(remap.command, remap.name, remap.instead) for remap in found] == rules


@pytest.mark.parametrize(
    ('environment', 'domain_id', 'is_seen'),
    [('ROS_DOMAIN_ID=7', 7, True), ('ROS_DOMAIN_ID=7', 8, False), ('HOME=/', 0, True)],
)
def test_who_was_started_in_another_domain_is_not_meant(
    monkeypatch, tmp_path, environment, domain_id, is_seen
):
    process = tmp_path / '4711'
    process.mkdir()
    (process / 'cmdline').write_text('talker\0--ros-args\0-r\0/a:=/b\0')
    (process / 'environ').write_text(f'{environment}\0')
    monkeypatch.setattr(remaps, 'PROCESSES', tmp_path)
    assert bool(remaps.of_domain(domain_id)) == is_seen


def test_the_report_names_rate_and_faults_in_order():
    assert report.tell(judge(healthy())) == (
        f'All is well on {TOPIC}: /talker publishes, /listener subscribes,'
        ' 5 Hz (10 messages in 2.0 s).'
    )
    lines = report.tell(judge(replaced(endpoints=(LISTENER,), **SILENT))).splitlines()
    assert [line[:12].strip() for line in lines[2:6]] == [
        '1. no publis',
        'expected',
        'saw',
        'to do',
    ]
    # a line of code is left whole, to be copied
    assert max(len(line) for line in lines[2:] if 'self.' not in line) <= 90


@pytest.mark.starts
@pytest.mark.parametrize(
    ('evidence', 'text'),
    [
        (healthy(), '/talker publishes, /listener subscribes, 5 Hz'),
        (replaced(endpoints=(), received=(), nodes={}), 'broken: no publisher (no publisher)'),
        (replaced(**SILENT), 'broken: /talker (the timer never fires)'),
    ],
)
def test_the_picture_says_in_words_what_it_shows(evidence, text):
    diagnosis = judge(evidence)
    assert text in picture.describe(diagnosis)
    assert picture.draw(diagnosis).startswith(b'\x89PNG')


NAME = '/close_gripper'
GRIPPER, WAVER = '/gripper', '/waver'


def service_end(kind, node_name, *, name=NAME, type_name='std_srvs/srv/SetBool'):
    return Endpoint(kind=kind, node_name=node_name, name=name, type_name=type_name)


SERVES, ASKS = service_end('server', GRIPPER), service_end('client', WAVER)


def healthy_service(**changes):
    evidence = ServiceEvidence(
        name=NAME,
        endpoints=(SERVES, ASKS),
        nodes={GRIPPER: NodeState(answers=True), WAVER: NodeState(answers=True)},
        looked_sec=0.1,
    )
    return dataclasses.replace(evidence, **changes)


def silent(node_name, **changes):
    nodes = healthy_service().nodes | {node_name: NodeState(answers=False)}
    return healthy_service(nodes=nodes, looked_sec=3.0, **changes)


def callback(node_name, name, **changes):
    return Callback(node_name=node_name, name=name, line='line 4: …', seconds=5.9, **changes)


DEADLOCK = callback(
    WAVER, 'ask', waits_in='call', waits_for=NAME, keeps='executor', holds=(WAVER,)
)
WORKING = callback(GRIPPER, 'move', service_name=NAME, holds=(GRIPPER,))
WAITING = callback(WAVER, 'ask', waits_in='wait_for_service', waits_for=NAME, holds=(WAVER,))
ELSEWHERE = dataclasses.replace(DEADLOCK, node_name='/other', holds=('/other',))
HERE = frozenset({GRIPPER, WAVER})
UNANSWERED = (Unanswered(node_name=WAVER, seconds=1.2),)


@pytest.mark.parametrize(
    ('evidence', 'titles'),
    [
        (healthy_service(), []),
        (healthy_service(endpoints=(SERVES,)), []),
        (healthy_service(endpoints=(ASKS,)), ['no server']),
        (
            healthy_service(endpoints=(ASKS,), missing_participants=1),
            ['a process that cannot be discovered', 'no server'],
        ),
        (
            healthy_service(endpoints=(ASKS,), elsewhere={7: (SERVES,)}),
            ['another domain ID', 'no server'],
        ),
        (
            healthy_service(endpoints=(ASKS,), callbacks=(WAITING,)),
            ['no server', 'a callback waits for the server'],
        ),
        (healthy_service(callbacks=(WAITING,)), []),  # it has come just now
        (
            healthy_service(endpoints=(SERVES, service_end('server', '/second'), ASKS)),
            ['several servers'],
        ),
        (healthy_service(endpoints=(SERVES, SERVES, ASKS)), ['several servers']),  # two programs
        (
            healthy_service(
                endpoints=(service_end('server', GRIPPER, name='/close_griper'), ASKS)
            ),
            ['a similar name: the spelling differs', 'no server'],
        ),
        (
            healthy_service(
                endpoints=(SERVES, service_end('client', WAVER, name='/close_griper'))
            ),
            ['a similar name: the spelling differs'],
        ),
        # that client has a server of its own
        (
            healthy_service(
                endpoints=(
                    SERVES,
                    service_end('client', WAVER, name=f'/left{NAME}'),
                    service_end('server', '/left/gripper', name=f'/left{NAME}'),
                )
            ),
            [],
        ),
        (
            healthy_service(
                endpoints=(SERVES, service_end('client', WAVER, type_name='std_srvs/srv/Trigger'))
            ),
            ['types differ'],
        ),
        (
            silent(WAVER, callbacks=(DEADLOCK,)),
            ['a callback waits for its own executor (deadlock)'],
        ),
        (healthy_service(callbacks=(ELSEWHERE,)), []),
        (healthy_service(raised={GRIPPER: 'TypeError'}), ['the callback returned no response']),
        (healthy_service(raised={GRIPPER: 'ValueError: x'}), ['the callback raised']),
        (healthy_service(raised={'/other': 'TypeError'}), []),
        (silent(GRIPPER, callbacks=(WORKING,)), ['a callback has not returned']),
        (silent(GRIPPER), ['the node answers nothing']),
        (silent(GRIPPER, visible=HERE, unspun=HERE), ['the node is not spinning']),
        (silent(GRIPPER, visible=HERE), []),  # it is spun: the machine is slow
        (silent(WAVER, visible=HERE, unspun=HERE), []),  # it may be spun when it asks
        (
            silent(WAVER, visible=HERE, unspun=HERE, unanswered=UNANSWERED),
            ['the node is not spinning'],
        ),
        (healthy_service(visible=HERE, unanswered=UNANSWERED), []),
    ],
)
def test_what_follows_from_what_was_seen_of_a_service(evidence, titles):
    assert [finding.title for finding in service_rules.judge(evidence).findings] == titles


@pytest.mark.parametrize(
    ('asker', 'wrong', 'right'),
    [
        # who asks has made the name relative, or has another one in mind
        (service_end('client', '/left/waver', name=f'/left{NAME}'), '/left/waver', NAME),
        (service_end('client', '/waver', name=f'/left{NAME}'), GRIPPER, f'/left{NAME}'),
    ],
)
def test_the_end_with_the_relative_name_is_to_be_edited(asker, wrong, right):
    evidence = healthy_service(name=f'/left{NAME}', endpoints=(SERVES, asker))
    first = service_rules.judge(evidence).findings[0]
    assert first.broken[0].node_name == wrong
    assert first.fix.startswith(f'if {right} is right, write it in {wrong}')
    assert ('without a leading /' in first.seen) is (wrong != GRIPPER)


@pytest.mark.parametrize(
    ('evidence', 'told'),
    [
        (healthy_service(), f'All is well on {NAME}: {GRIPPER} serves, {WAVER} asks.'),
        (healthy_service(endpoints=(SERVES,)), f'All is well on {NAME}: {GRIPPER} serves, nobody'),
        (healthy_service(visible=HERE, unanswered=UNANSWERED), f'one of {WAVER} has no response'),
        (silent(WAVER, callbacks=(DEADLOCK,)), 'it has waited for at least 5 s'),
        (silent(GRIPPER), 'it has answered nothing for at least 3 s'),
    ],
)
def test_a_report_on_a_service(evidence, told):
    assert told in ' '.join(report.tell(service_rules.judge(evidence)).split())


@pytest.mark.parametrize(
    'evidence',
    [
        # a request waits because its node can't take the response: it is not lost
        silent(WAVER, visible=HERE, unanswered=UNANSWERED, callbacks=(DEADLOCK,)),
        # nobody can look into the server: it may be at work
        healthy_service(visible=frozenset({WAVER}), unanswered=UNANSWERED),
    ],
)
def test_a_request_is_called_lost_only_if_it_is(evidence):
    assert 'has no response' not in report.summary(evidence)


def test_a_callback_that_holds_a_topic_up_is_named_there_too():
    waits = dataclasses.replace(DEADLOCK, node_name='/talker', holds=('/talker',))
    seen = replaced(nodes={'/talker': NodeState(answers=False)}, callbacks=(waits,), **SILENT)
    assert judge(seen).findings[0].title == 'a callback waits for its own executor (deadlock)'
    assert [each.title for each in judge(seen).findings if 'spinning' in each.title] == []


@pytest.mark.starts
@pytest.mark.parametrize(
    ('evidence', 'text'),
    [
        (healthy_service(), f'{GRIPPER} serves, {WAVER} asks'),
        (healthy_service(endpoints=(ASKS,)), 'broken: no server (no server)'),
        (silent(WAVER, callbacks=(DEADLOCK,)), f'broken: {WAVER} (a callback waits'),
    ],
)
def test_the_picture_of_a_service_says_in_words_what_it_shows(evidence, text):
    diagnosis = service_rules.judge(evidence)
    assert text in picture.describe(diagnosis)
    assert picture.draw(diagnosis).startswith(b'\x89PNG')


def test_several_servers_are_named_with_what_comes_of_it():
    evidence = healthy_service(endpoints=(SERVES, service_end('server', '/second'), ASKS))
    (finding,) = service_rules.judge(evidence).findings
    assert finding.seen.startswith('2 servers, of /gripper and /second: each of them works on')


def test_a_web_page_says_the_same_and_leaves_lines_to_the_window():
    evidence = healthy_service(endpoints=(service_end('client', '/<waver>'),))
    diagnosis = service_rules.judge(evidence)
    page, text = as_html.tell_as_html(diagnosis), report.tell(diagnosis)
    assert page.count('<li>') == len(diagnosis.findings) == 1
    assert '<waver>' not in page
    shown = html.unescape(re.sub(r'<[^>]+>', ' ', page))
    assert set(shown.split()) == set(text.split()) - {'1.'}
    code = re.search('<pre [^>]+>(.+)</pre>', page)[1]
    assert html.unescape(code) == diagnosis.findings[0].code
    well = as_html.tell_as_html(service_rules.judge(healthy_service()))
    assert '<ol>' not in well
    assert 'All is well on /close_gripper' in well
