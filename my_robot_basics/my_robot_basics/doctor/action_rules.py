"""Rules about the faults of an action; some are those of `doctor.rules`.

`RULES` is in the order of likelihood: a cause comes before the consequence that it explains.
"""

from collections.abc import Callable, Iterable, Iterator

from my_robot_basics.doctor import code
from my_robot_basics.doctor.client_types import clients_of_another_type, types_differ
from my_robot_basics.doctor.evidence import Diagnosis, Finding
from my_robot_basics.doctor.rules import callbacks, endpoints, names
from my_robot_basics.doctor.served_evidence import ActionEvidence


def no_server(evidence: ActionEvidence) -> Iterator[Finding]:
    """The action has no server.

    Name the action clients without a server, and the other running nodes.
    """
    if evidence.servers:
        return
    sending = sorted({end.node_name for end in evidence.clients})
    types = [end.type_name for end in evidence.clients]
    others = ', '.join(name for name in evidence.nodes if name not in sending)
    yield Finding(
        title='no action server',
        expected=f'a server of {evidence.name}',
        seen=f'none; clients: {" and ".join(sending) or "none"}; other nodes: {others or "none"}',
        fix='start the node that serves it, and check that its constructor has this line; a goal'
        ' that is sent before is lost, so send it again',
        code=code.creation_line(
            'server', type_name=(types or ['/action/'])[0], name=evidence.name
        ),
        missing='server',
    )


def different_types(evidence: ActionEvidence) -> Iterator[Finding]:
    """The client and the server were created with different action types.

    Name both types; the server's type is taken as the right one.
    """
    for client, server, type_name in clients_of_another_type(evidence.servers, evidence.clients):
        yield types_differ(
            client,
            type_name,
            evidence.name,
            expected='one action type at both ends',
            seen=f'{server} serves {type_name}, {client.node_name} sends goals of'
            f' {client.type_name}: none arrives',
        )


def raised(evidence: ActionEvidence) -> Iterator[Finding]:
    """The execute callback has raised an exception, so that its goal was aborted.

    Say what was raised.
    """
    for node_name, what in evidence.raised:
        seen = f'it raised an exception a moment ago ({what}), and the goal was aborted'
        fix = 'fix that, and send the goal again'
        if not what:  # as the TypeError of publish_feedback
            seen = 'it raised an exception without a text a moment ago, and the goal was aborted'
            fix = (
                "give publish_feedback an object of the action's Feedback, such as "
                'MoveArm.Feedback(position=…, remaining=…), and send the goal again'
            )
        yield Finding(
            title='the execute callback raised',
            expected=f'the execute callback of {node_name} to return a result',
            seen=seen,
            fix=fix,
            broken=tuple(end for end in evidence.servers if end.node_name == node_name),
        )


def unset_status(evidence: ActionEvidence) -> Iterator[Finding]:
    """The execute callback has not set its goal's status, so that rclpy aborted the goal.

    Show the missing line; callbacks that raised are left out, as they could not reach it.
    """
    for node_name in sorted(evidence.unset - {name for name, _ in evidence.raised}):
        yield Finding(
            title='nobody has set how the goal ended',
            expected=f'the execute callback of {node_name} to call succeed(), canceled() or'
            ' abort() before it returns',
            seen='it returned without, a moment ago: rclpy aborts such a goal',
            fix='call it when the goal is reached, before the callback returns',
            code='goal_handle.succeed()',
            broken=tuple(end for end in evidence.servers if end.node_name == node_name),
        )


_FIX = {
    'accepted': (
        'a handle_accepted_callback has to call this; without one, the execute callback begins by'
        ' itself when the node is spun',
        'goal_handle.execute()',
    ),
    'executing': (
        'if it only takes long, wait, and publish feedback in each step; else end the loop of the'
        ' execute callback, or what it waits for',
        'goal_handle.publish_feedback(feedback)',
    ),
    'canceling': (
        'look at goal_handle.is_cancel_requested in each step of the execute callback; if it is'
        ' True, call this, and return the result',
        'goal_handle.canceled()',
    ),
}


def stands_still(evidence: ActionEvidence) -> Iterator[Finding]:
    """An unfinished goal makes no progress and gets no feedback: it may never end.

    Name the goal's state, and how long it was observed.
    """
    busy = {each.node_name for each in evidence.callbacks}
    if any(end.node_name in busy for end in evidence.servers):
        return  # a callback blocks the server, which another rule reports
    for state in sorted({goal.state for goal in evidence.goals}):
        seconds = min(goal.seconds for goal in evidence.goals if goal.state == state)
        fix, line = _FIX[state]
        yield Finding(
            title='a goal does not go on',
            expected='a goal to end, or feedback on it',
            seen=f'a goal that was {state} for at least {int(seconds)} s, and no feedback',
            fix=fix,
            code=line,
            broken=evidence.servers,
        )


RULES: tuple[Callable[[ActionEvidence], Iterable[Finding]], ...] = (
    names.remapped,
    names.similar_name,
    endpoints.discovery_range,
    endpoints.other_domain,
    no_server,
    different_types,
    callbacks.blocks_itself,
    raised,
    unset_status,
    callbacks.not_returning,
    stands_still,
)


def judge(evidence: ActionEvidence) -> Diagnosis:
    """Return all findings of the rules, the likeliest first."""
    findings = tuple(finding for examine in RULES for finding in examine(evidence))
    return Diagnosis(evidence, findings)
