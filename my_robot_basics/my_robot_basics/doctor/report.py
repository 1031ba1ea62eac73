"""A diagnosis in words for a beginner."""

import textwrap

from my_robot_basics.doctor.evidence import Diagnosis, Evidence, Finding, Kind
from my_robot_basics.session.errors import COLUMNS

INDENT = ' ' * 13
"""Below the words of a paragraph, whose labels stand before them."""


def tell(diagnosis: Diagnosis) -> str:
    """The whole answer: one paragraph a fault, the likeliest first, or that all is well."""
    evidence = diagnosis.evidence
    if not diagnosis.findings:
        return f'All is well on {evidence.topic_name}: {summary(evidence)}.'
    many = len(diagnosis.findings) > 1
    lines = [
        f'Something is wrong on {evidence.topic_name}'
        f'{", the likeliest first" if many else ""}: {summary(evidence)}.'
    ]
    lines += [_paragraph(i, finding) for i, finding in enumerate(diagnosis.findings, start=1)]
    return '\n\n'.join(lines)


def summary(evidence: Evidence) -> str:
    """Which nodes are there, and what was received: one clause."""
    senders = _names(evidence, 'publisher', 'publishes', 'publish')
    listeners = _names(evidence, 'subscription', 'subscribes', 'subscribe')
    return f'{senders}, {listeners}{_received(evidence)}'


def _received(evidence: Evidence) -> str:
    if not evidence.listened_sec:
        return ''
    number = len(evidence.fresh)
    if evidence.rate_hz:
        return f', {evidence.rate_hz:.3g} Hz ({number} messages in {evidence.listened_sec:.1f} s)'
    if number:
        return f', 1 message in {evidence.listened_sec:.1f} s'
    kept = len(evidence.received)
    latched = f' ({kept} kept from before)' if kept else ''
    return f', no new message in {evidence.listened_sec:.1f} s{latched}'


def _names(evidence: Evidence, kind: Kind, verb: str, plural: str) -> str:
    names = sorted({end.node_name for end in evidence.ends(kind)})
    if not names:
        return f'nobody {verb}'
    return f'{" and ".join(names)} {verb if len(names) == 1 else plural}'


def _paragraph(number: int, finding: Finding) -> str:
    fix = f'{finding.fix}{":" if finding.code else ""}'
    told = {'expected': finding.expected, 'saw': finding.seen, 'to do': fix}
    lines = [f'{number}. {finding.title}']
    for label, text in told.items():
        lines += textwrap.wrap(
            text,
            COLUMNS,
            initial_indent=f'   {label:10}',
            subsequent_indent=INDENT,
            break_long_words=False,
            break_on_hyphens=False,
        )
    if finding.code:
        lines.append(f'{INDENT}{finding.code}')  # in one line, to be copied
    return '\n'.join(lines)
