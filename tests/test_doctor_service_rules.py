"""What a rule on services concludes from evidence, without a graph."""

import dataclasses
import html
import re

import pytest
from made_evidence import (
    ASKS,
    DEADLOCK,
    GRIPPER,
    NAME,
    SERVES,
    WAVER,
    callback,
    healthy_service,
    service_end,
    silent,
)
from my_robot_basics.doctor import as_html, picture, report, service_rules
from my_robot_basics.doctor.served_evidence import Unanswered

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
def test_each_evidence_of_a_service_leads_to_its_findings(evidence, titles):
    assert [finding.title for finding in service_rules.judge(evidence).findings] == titles


@pytest.mark.parametrize(
    ('asker', 'wrong', 'right'),
    [
        # the client has made its name relative, or it wants a different service
        (service_end('client', '/left/waver', name=f'/left{NAME}'), '/left/waver', NAME),
        (service_end('client', '/waver', name=f'/left{NAME}'), GRIPPER, f'/left{NAME}'),
    ],
)
def test_the_fix_of_a_wrong_namespace_names_the_node_to_edit(asker, wrong, right):
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
def test_a_report_on_a_service_names_nodes_and_waiting_times(evidence, told):
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
def test_a_request_that_may_still_be_answered_is_not_called_lost(evidence):
    assert 'has no response' not in report.summary(evidence)


@pytest.mark.starts
@pytest.mark.parametrize(
    ('evidence', 'text'),
    [
        (healthy_service(), f'{GRIPPER} serves, {WAVER} asks'),
        (healthy_service(endpoints=(ASKS,)), 'broken: no server (no server)'),
        (silent(WAVER, callbacks=(DEADLOCK,)), f'broken: {WAVER} (a callback waits'),
    ],
)
def test_the_picture_of_a_service_has_a_description_in_words(evidence, text):
    diagnosis = service_rules.judge(evidence)
    assert text in picture.describe(diagnosis)
    assert picture.draw(diagnosis).startswith(b'\x89PNG')


def test_several_servers_are_reported_with_the_consequence():
    evidence = healthy_service(endpoints=(SERVES, service_end('server', '/second'), ASKS))
    (finding,) = service_rules.judge(evidence).findings
    assert finding.seen.startswith('2 servers, of /gripper and /second: each of them works on')


def test_a_report_as_html_has_the_words_of_the_report_as_text():
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
