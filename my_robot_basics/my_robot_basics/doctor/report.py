"""A diagnosis as text for beginners."""

from functools import partial

from wcwidth import ljust

from my_robot_basics.doctor.evidence import (
    VERBS,
    Diagnosis,
    Evidence,
    Finding,
    GraphEvidence,
    Kind,
)
from my_robot_basics.doctor.served_evidence import ActionEvidence, ServiceEvidence
from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.lines import in_lines
from my_robot_basics.language.speaking import in_language, put
from my_robot_basics.session.errors import COLUMNS

_PLURALS: dict[Kind, str] = {
    'publisher': 'publish',
    'subscription': 'subscribe',
    'client': 'ask',
    'server': 'serve',
}
TO_SHOW: tuple[str, ...] = ('expected', 'saw', 'to do')
TO_SHOW += ('publishes', 'subscribes', 'asks', 'serves')
TO_SHOW += ('{node} publishes on {name}', '{node} subscribes on {name}')
TO_SHOW += ('{node} asks {name}', '{node} serves {name}')
TO_SHOW += ('nobody publishes', 'nobody subscribes', 'nobody asks', 'nobody serves')
TO_SHOW += ('{names} publishes', '{names} subscribes', '{names} asks', '{names} serves')
TO_SHOW += ('{names} publish', '{names} subscribe', '{names} ask', '{names} serve')
TO_SHOW += ('publisher', 'subscription', 'client', 'server', 'a client of {name}')
"""Texts for `./course translate` that it does not find in f-strings of the code."""
INDENT = ' ' * 13
"""The indentation of a paragraph's text, which is to the right of its labels."""


def tell(diagnosis: Diagnosis, language: str = ENGLISH) -> str:
    """Return the whole diagnosis: one paragraph for each fault, or that all is well."""
    findings = enumerate(diagnosis.findings, start=1)
    paragraphs = [_paragraph(i, finding, language) for i, finding in findings]
    return '\n\n'.join([first_sentence(diagnosis, language), *paragraphs])


def first_sentence(diagnosis: Diagnosis, language: str) -> str:
    """Return the first sentence: whether there is a fault, and a summary of the evidence."""
    evidence = diagnosis.evidence
    if not diagnosis.findings:
        return in_language(language, f'All is well on {evidence.name}: {summary(evidence)}.')
    many = len(diagnosis.findings) > 1
    said = f'Something is wrong on {evidence.name}: {summary(evidence)}.'
    if many:
        said = f'Something is wrong on {evidence.name}, the likeliest first: {summary(evidence)}.'
    return in_language(language, said)


def summary(evidence: GraphEvidence) -> str:
    """Return in one clause which nodes use the name, and what was observed of them."""
    first, second = evidence.KINDS if isinstance(evidence, Evidence) else evidence.KINDS[::-1]
    told = f'{_names(evidence, first)}, {_names(evidence, second)}'
    if isinstance(evidence, Evidence):
        told += _received(evidence)
    if isinstance(evidence, ServiceEvidence) and evidence.servers:
        told += _lost(evidence)
    if isinstance(evidence, ActionEvidence) and evidence.proceeding:
        told += (
            f'; {evidence.proceeding} goals go on'
            if evidence.proceeding > 1
            else '; 1 goal goes on'
        )
    return told


def _received(evidence: Evidence) -> str:
    if not evidence.listened_sec:
        return ''
    number = len(evidence.fresh)
    if evidence.rate_hz:
        return f', {evidence.rate_hz:.3g} Hz ({number} messages in {evidence.listened_sec:.1f} s)'
    if number:
        return f', 1 message in {evidence.listened_sec:.1f} s'
    kept = len(evidence.received)
    if kept:
        return f', no new message in {evidence.listened_sec:.1f} s ({kept} kept from before)'
    return f', no new message in {evidence.listened_sec:.1f} s'


def _lost(evidence: ServiceEvidence) -> str:
    """Return a note on requests without an answer; it is no fault: the next request gets one."""
    idle = all(end.node_name in evidence.visible for end in evidence.servers)
    spun = [e.node_name for e in evidence.unanswered if evidence.state(e.node_name).answers]
    names = sorted({*spun})
    if not names or not idle:
        return ''
    return (
        f'; no server works on a request, and one of {" and ".join(names)} has no response: it'
        ' was sent while there was no server (then service_is_ready() is False), or its callback'
        ' raised'
    )


def _names(evidence: GraphEvidence, kind: Kind) -> str:
    names = sorted({end.node_name for end in evidence.ends(kind)})
    if not names:
        return f'nobody {VERBS[kind]}'
    verb = VERBS[kind] if len(names) == 1 else _PLURALS[kind]
    return f'{" and ".join(names)} {verb}'


def _paragraph(number: int, finding: Finding, language: str) -> str:
    lines = [f'{number}. {in_language(language, finding.title)}']
    for label, text in fields(finding, language).items():
        lines += in_lines(text, COLUMNS, first=f'   {ljust(label, 10)}', rest=INDENT)
    if finding.code:
        lines.append(f'{INDENT}{finding.code}')  # not broken, so that it can be copied
    return '\n'.join(lines)


def fields(finding: Finding, language: str) -> dict[str, str]:
    """Return the texts about a fault by their labels, in a language."""
    say = partial(in_language, language)
    fix = say(finding.fix)
    if finding.code:
        fix = put(language, '{one}: {other}', one=fix, other='').rstrip()
    return {
        say('expected'): say(finding.expected),
        say('saw'): say(finding.seen),
        say('to do'): fix,
    }
