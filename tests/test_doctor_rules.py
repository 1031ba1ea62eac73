"""What a rule on topics concludes from evidence, without a graph."""

import dataclasses
from collections.abc import Iterator
from importlib import import_module
from inspect import isfunction
from pkgutil import iter_modules
from typing import get_type_hints

import pytest
from made_evidence import DEADLOCK, SILENT, TOPIC, end, healthy, replaced
from my_robot_basics.doctor import action_rules, picture, remaps, report, rules, service_rules
from my_robot_basics.doctor.evidence import Finding, NodeState
from my_robot_basics.doctor.remaps import remaps_in_command
from my_robot_basics.doctor.rules import judge


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
def test_no_fault_is_found_in_a_healthy_topic(evidence):
    assert judge(evidence).findings == ()


TALKER, LISTENER = healthy().endpoints


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
def test_each_evidence_of_a_topic_leads_to_its_findings(evidence, titles):
    assert [finding.title for finding in judge(evidence).findings] == titles


@pytest.mark.parametrize(
    ('node_name', 'received', 'job'),
    [
        ('/talker', SILENT, 'its timers fire'),
        ('/listener', {}, 'the callback is called'),
    ],
)
def test_a_node_that_is_not_spinning_is_reported_with_the_consequence(node_name, received, job):
    seen = replaced(nodes={node_name: NodeState(answers=False)}, **received)
    (finding,) = judge(seen).findings
    assert finding.expected == f'{node_name} to be spun, so that {job}'


def with_bursts(*firsts, number=6, depth=1):
    """Return evidence of 100 Hz in which, at each of `firsts`, `number` messages came at once."""
    evidence = healthy(rate_hz=100.0, number=200)
    received = list(evidence.received)
    for first in firsts:
        for i in range(first, first + number):
            received[i] = dataclasses.replace(
                received[i], sent_sec=received[first + number - 1].sent_sec
            )
    ends = end('publisher', '/talker', depth=depth), end('subscription', '/listener')
    return replaced(evidence, received=tuple(received), endpoints=ends)


@pytest.mark.parametrize(
    ('evidence', 'titles'),
    [
        (with_bursts(50), []),  # a machine that stood still for a moment
        (with_bursts(50, 120), []),
        (with_bursts(*range(0, 180, 10)), ['messages lost to a short queue']),
        (with_bursts(*range(0, 180, 10), depth=5), ['messages lost to a short queue']),
        (with_bursts(*range(0, 180, 10), depth=6), []),  # a whole burst has room in it
        (with_bursts(*range(0, 195, 8), number=5), ['messages lost to a short queue']),
        (with_bursts(*range(0, 195, 8), number=4), []),  # so few messages are no burst
    ],
)
def test_only_repeated_bursts_that_exceed_the_queue_are_reported(evidence, titles):
    assert [finding.title for finding in judge(evidence).findings] == titles


def test_the_publisher_without_a_subscription_is_blamed_for_a_similar_name():
    met = '/kinematics/joint_statez'
    ends = (
        LISTENER,
        end('publisher', '/busy', topic_name=met),
        end('subscription', '/its_listener', topic_name=met),
        end('publisher', '/lonely', topic_name='/kinematics/joint_stats'),
    )
    first = judge(replaced(endpoints=ends, **SILENT)).findings[0]
    assert first.broken[0].node_name == '/lonely'


def test_a_misspelt_topic_name_is_answered_with_the_correct_command():
    asked = replaced(name='/kinematic/joint_state', **SILENT)
    first = judge(asked).findings[0]
    assert first.code == f'$ topic_doctor {TOPIC}'


def test_an_empty_domain_is_reported_with_a_hint_at_other_domains():
    empty = replaced(endpoints=(), nodes={}, **SILENT)
    assert '--domains' in judge(empty).findings[0].fix
    looked = replaced(empty, elsewhere={7: (LISTENER,)})
    assert not any('--domains' in finding.fix for finding in judge(looked).findings)


def test_every_rule_is_in_its_table():
    tabled = {rule for table in (rules, service_rules, action_rules) for rule in table.RULES}
    homes = [
        import_module(f'{rules.__name__}.{each.name}') for each in iter_modules(rules.__path__)
    ]
    written = {
        member
        for home in (*homes, service_rules, action_rules)
        for name, member in vars(home).items()
        if isfunction(member) and member.__module__ == home.__name__ and not name.startswith('_')
        if get_type_hints(member)['return'] == Iterator[Finding]
    }
    assert tabled == written


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
    found = remaps_in_command(words)
    assert [(remap.command, remap.name, remap.instead) for remap in found] == rules


@pytest.mark.parametrize(
    ('environment', 'domain_id', 'is_seen'),
    [('ROS_DOMAIN_ID=7', 7, True), ('ROS_DOMAIN_ID=7', 8, False), ('HOME=/', 0, True)],
)
def test_remappings_of_processes_in_a_different_domain_are_ignored(
    monkeypatch, tmp_path, environment, domain_id, is_seen
):
    process = tmp_path / '4711'
    process.mkdir()
    (process / 'cmdline').write_text('talker\0--ros-args\0-r\0/a:=/b\0')
    (process / 'environ').write_text(f'{environment}\0')
    monkeypatch.setattr(remaps, 'PROCESSES', tmp_path)
    assert bool(remaps.remaps_in_domain(domain_id)) == is_seen


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
    # lines of code are not wrapped, so that they can be copied
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
def test_the_picture_of_a_topic_has_a_description_in_words(evidence, text):
    diagnosis = judge(evidence)
    assert text in picture.describe(diagnosis)
    assert picture.draw(diagnosis).startswith(b'\x89PNG')


def test_a_deadlock_is_reported_on_the_topic_that_it_holds_up():
    waits = dataclasses.replace(DEADLOCK, node_name='/talker', holds=('/talker',))
    seen = replaced(nodes={'/talker': NodeState(answers=False)}, callbacks=(waits,), **SILENT)
    assert judge(seen).findings[0].title == 'a callback waits for its own executor (deadlock)'
    assert [each.title for each in judge(seen).findings if 'spinning' in each.title] == []
