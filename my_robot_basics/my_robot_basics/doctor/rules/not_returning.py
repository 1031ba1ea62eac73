"""A callback does not return, and meanwhile no other callback of its node can run."""

from collections.abc import Iterator

from my_robot_basics.doctor.callback import Callback
from my_robot_basics.doctor.evidence import Finding, GraphEvidence
from my_robot_basics.doctor.rules.blocks_itself import ASK, LATER


def examine(evidence: GraphEvidence) -> Iterator[Finding]:
    """Name the callback, how long it was observed, and the line that it executes."""
    for each in evidence.callbacks:
        serves = each.service_name == evidence.name
        ends = [
            end
            for end in evidence.all_ends()
            if end.node_name in each.holds or (serves and end.node_name == each.node_name)
        ]
        if not ends or each.keeps or each.waits_in == 'wait_for_service':
            continue
        job = 'its response is sent' if serves else f'{ends[0].node_name} can go on'
        yield Finding(
            title='a callback has not returned',
            expected=f'the callback {each.name} of {each.node_name} to return, so that {job}',
            seen=_seen(each),
            fix=LATER
            if each.asks
            else 'if it waits for something that does not come, end that; if it only takes long,'
            ' wait, or make the long task an action',
            code=ASK if each.asks else '',
            broken=tuple(ends[:1]),
        )


def _seen(callback: Callback) -> str:
    where = callback.line or 'a line that is not known'
    if callback.asks:
        return (
            f'it has been running for at least {int(callback.seconds)} s, and is in {where}; '
            f"until it returns, the response of {callback.asks} can't be taken"
        )
    return f'it has been running for at least {int(callback.seconds)} s, and is in {where}'
