"""The two ends were created with different message types."""

from collections.abc import Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.evidence import Evidence, Finding


def examine(evidence: Evidence) -> Iterator[Finding]:
    """Name both types; the publisher's type is taken as the right one."""
    types = {publisher.type_name: publisher.node_name for publisher in evidence.publishers}
    for subscription in evidence.subscriptions:
        if not types or subscription.type_name in types:
            continue
        type_name, sender = next(iter(types.items()))
        yield Finding(
            title='types differ',
            expected='one message type at both ends',
            seen=f'{sender} publishes {type_name}, {subscription.node_name} expects'
            f' {subscription.type_name}: no message arrives',
            fix=f'use the same type in {subscription.node_name}'
            f' (from {type_name.replace("/", ".").rpartition(".")[0]})',
            code=code.creation_line('subscription', type_name=type_name, name=evidence.name),
            broken=(subscription,),
        )
