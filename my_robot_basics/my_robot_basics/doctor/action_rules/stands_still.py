"""An unfinished goal makes no progress and gets no feedback: it may never end."""

from collections.abc import Iterator

from my_robot_basics.doctor.action_evidence import ActionEvidence
from my_robot_basics.doctor.evidence import Finding

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


def examine(evidence: ActionEvidence) -> Iterator[Finding]:
    """Name the goal's state, and how long it was observed."""
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
