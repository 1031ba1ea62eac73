"""Why a request, goal or report of `arm_player` is missing or wrong: one clause each."""

import math
from collections.abc import Sequence

from my_robot_basics.checks.actions.goal_senders import WAITS
from my_robot_basics.checks.packages import player_report
from my_robot_basics.checks.packages.player_servers import (
    MOVE_ARM,
    SOLVE_IK,
    PlayerServers,
    is_near,
)
from my_robot_basics.checks.services.services import answers_parameters
from my_robot_basics.checks.services.waiting_clients import waits_for_answer
from my_robot_basics.checks.values import joints
from my_robot_basics.checks.values.solutions import request, solve
from my_robot_basics.graph import actions, graphs, services
from my_robot_basics.graph.watcher import Watcher

NODE = '/arm_player'
_AFTER = {
    'unreachable': 'if response.reachable is False, note it and go on with the next target',
    'rejected': 'a goal that is not accepted has no result: note that, and go on with the next',
    'canceled': 'a goal that was canceled has a result, too: note its status and go on',
    'aborted': 'a goal that was aborted has a result, too: note its status and go on',
}

_SKIPPED = 'visit those of the parameter targets, in their order, and leave none out'
_LEFT_OUT = (
    'the report came before this target was visited: go on until the last target of the '
    'parameter, whatever becomes of the others'
)
_NONE_THERE = 'send no goal if response.reachable is False: it has no angles'


def why_no_client(watcher: Watcher) -> str:
    """Why `/solve_ik` has no client."""
    return services.take_graph(watcher.node).why_none(SOLVE_IK, maker='create_client')


def why_not_asked(
    watcher: Watcher, word_before: str, *, was_skipped: bool, is_left_out: bool
) -> tuple[str, str]:
    """Why no request comes for a target: the hint, and the cause in a few words.

    `word_before`: how the target before it ended, '' for the first one; `was_skipped`: whether a
    request for a later target came; `is_left_out`: it is the last one, and the report came.
    """
    if was_skipped or is_left_out:
        return _LEFT_OUT if is_left_out else _SKIPPED, 'a target is skipped'
    cause = f'{SOLVE_IK} is not asked'
    if word_before:
        cause = f'{NODE} stops after a target that is {word_before}'
    return _why_silent(watcher, word_before), cause


def _why_silent(watcher: Watcher, word_before: str) -> str:
    if not answers_parameters(watcher, NODE):
        return waits_for_answer(SOLVE_IK) if word_before else _NO_SPIN
    if word_before in _AFTER:
        return _AFTER[word_before]
    if word_before:
        return 'when the result of a goal is there, go on with the next target'
    return (
        'wait until there is a server (wait_for_service), then call call_async for each target; '
        'read the parameter targets with get_parameter'
    )


def why_no_goal(watcher: Watcher) -> str:
    """Why no goal comes, although a request was answered."""
    if not answers_parameters(watcher, NODE):
        return waits_for_answer(SOLVE_IK)
    ends = actions.take_graph(watcher.node)
    if not ends.clients.get(MOVE_ARM):
        return ends.why_none(MOVE_ARM, maker='ActionClient')
    return 'when the answer is there, send its elbow_up as a goal with send_goal_async'


def why_no_report(watcher: Watcher) -> str:
    """Why no report comes at the end."""
    if not answers_parameters(watcher, NODE):
        return WAITS
    ends = graphs.take_snapshot(watcher)
    if not ends.publishers(player_report.TOPIC):
        return ends.why_no_message(player_report.TOPIC)
    return 'publish it when the last target is done'


def why_other_goal(servers: PlayerServers, number: int, seen: Sequence[float]) -> str:
    """Why the position of a goal is not that of a target."""
    if not seen:
        return _NONE_THERE
    _, x, y = servers.targets[number]
    answer = servers.solver.answer(request(x, y))
    if is_near(seen, answer.elbow_down):
        return 'this is elbow_down: send response.elbow_up'
    if is_near(seen, solve(request(x, y)).elbow_up):
        return 'send the angles of the response, not a solution of your own'
    if is_near(seen, [math.degrees(angle) for angle in answer.elbow_up]):
        return 'put response.elbow_up into goal.position as it is: in radians'
    others = [n for n in range(len(servers.targets)) if is_near(seen, servers.pose(n))]
    if others and others[0] < number:
        return 'this target has had its goal: send one for each target, whatever became of it'
    if others:
        return 'keep to the order of the targets, and leave none out'
    if number and servers.targets[number - 1][0] == 'unreachable':
        return _NONE_THERE
    return joints.why_off(list(seen[:4]), [math.degrees(angle) for angle in answer.elbow_up])


_NO_SPIN = (
    'the node answers nothing: spin it while it waits, outside of its callbacks with '
    'rclpy.spin_until_future_complete, or inside by call_async and add_done_callback'
)
