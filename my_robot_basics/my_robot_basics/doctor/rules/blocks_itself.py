"""A callback waits for a response that can't be taken while the callback waits: a deadlock."""

from collections.abc import Iterator

from my_robot_basics.doctor.callback import Keeps
from my_robot_basics.doctor.evidence import Finding, GraphEvidence

_WHY: dict[Keeps, str] = {
    'executor': "its executor has one thread, which can't take the response meanwhile",
    'threads': 'all threads of its executor wait like this, so that none can take the response',
    'group': 'the client is in the same callback group, where no other callback can run meanwhile,'
    ' not even the one that takes the response',
}
ASK = 'self.client.call_async(request).add_done_callback(self.receive)'
LATER = 'use call_async, and go on in the function that add_done_callback calls'
_GROUP = 'give the client a group that lets others run (callback_group=ReentrantCallbackGroup())'
_FIX: dict[str, str] = {
    'call': f'{LATER}; or {_GROUP}, and spin the node with a MultiThreadedExecutor',
    'await': f'{_GROUP}; or {LATER}',
    'spin_until_future_complete': f'{LATER}: a callback must not spin its own node',
}


def examine(evidence: GraphEvidence) -> Iterator[Finding]:
    """Name the callback, and how to avoid the deadlock."""
    for each in evidence.callbacks:
        ends = [end for end in evidence.all_ends() if end.node_name == each.node_name]
        if not (each.keeps and ends):
            continue
        yield Finding(
            title='a callback waits for its own executor (deadlock)',
            expected=f'the callback {each.name} of {each.node_name} to return, so that the'
            ' response can be taken',
            seen=f'it has waited for at least {int(each.seconds)} s, for the response of'
            f' {each.waits_for}, in {each.line or each.waits_in}; {_WHY[each.keeps]}',
            fix=_FIX[each.waits_in],
            code=ASK,
            broken=tuple(ends[:1]),
        )
