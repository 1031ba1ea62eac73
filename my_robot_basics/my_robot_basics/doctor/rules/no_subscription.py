"""The topic has no subscription."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name the nodes that publish on it."""
    if evidence.subscriptions:
        return
    senders = ' and '.join(end.node_name for end in evidence.publishers)
    types = [end.type_name for end in evidence.publishers]
    yield Finding(
        title='no subscription',
        expected=f'a subscription on {evidence.name}',
        seen=f'none; the publisher belongs to {senders}' if senders else 'none',
        fix='start the node that subscribes, and check that its constructor has this line',
        code=code.creation_line('subscription', type_name=(types or [''])[0], name=evidence.name),
        missing='subscription',
    )
