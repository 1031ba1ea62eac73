"""Send an action goal."""

import argparse
import math
import sys
from typing import Any

from my_robot_basics.ros2 import arguments, completion, lookup, stopping, typed_values
from my_robot_basics.ros2.errors import CommandError, Stopped
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'action_name',
        completer=completion.action_names,
        help="Name of the ROS action (e.g. '/fibonacci')",
    )
    completion.add_argument(
        parser,
        'action_type',
        completer=completion.action_types_of,
        help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')",
    )
    source = parser.add_mutually_exclusive_group()
    completion.add_argument(
        source,
        'goal',
        completer=completion.goal_prototype,
        nargs='?',
        default='{}',
        help="Goal request values in YAML format (e.g. '{order: 10}')",
    )
    source.add_argument('--stdin', action='store_true', help='Read goal from standard input')
    parser.add_argument(
        '-f', '--feedback', action='store_true', help='Echo feedback messages for the goal'
    )
    parser.add_argument(
        '--timeout',
        metavar='N',
        type=arguments.unsigned_int,
        help='Wait for N seconds at most for the action server, for its answer to the goal, and '
        'for the result each',
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    from my_robot_basics.ros2.interfaces import action_class_for

    action_class = action_class_for(args.action_type)
    goal = action_class.Goal()
    _fill(goal, typed_values.parse(sys.stdin.buffer.read() if args.stdin else args.goal))

    node_name = f'_ros2cli_send_goal_{args.action_type.replace("/", "_")}'
    with Graph(args, node_name=node_name) as graph:
        from rclpy.action import ActionClient

        action_name = lookup.full_name(graph.node, args.action_name)
        client = ActionClient(graph.node, action_class, action_name)
        try:
            print('Waiting for an action server to become available...')
            limit_sec = math.inf if args.timeout is None else args.timeout
            if not graph.wait_until(client.server_is_ready, timeout_sec=limit_sec):
                raise CommandError(
                    f'Action server is not available after waiting {limit_sec} seconds.'
                )
            print(f'Sending goal:\n     {completion.fields_as_yaml(goal)}')
            _send(graph, client, goal, show_feedback=args.feedback, limit_sec=limit_sec)
        finally:
            client.destroy()


def _fill(goal: Any, values: Any) -> None:
    from my_robot_basics.ros2.fill import BadValue, fill

    try:
        if not isinstance(values, dict):
            kind = type(values).__name__
            raise BadValue(f"Value '{values}' is expected to be a dictionary but is a {kind}")
        fill(goal, values)
    except BadValue as error:
        raise CommandError(f'Failed to populate message fields: {error}') from None


def _send(graph: Graph, client: Any, goal: Any, *, show_feedback: bool, limit_sec: float) -> None:
    """Send a goal and wait for its result; a signal cancels it, a second one ends the wait.

    If the goal takes longer than `limit_sec`, it is cancelled, and CommandError is raised.
    """
    accepting = client.send_goal_async(goal, _show_feedback if show_feedback else None)
    handle = _answer(graph, accepting, 'sending goal', limit_sec=limit_sec)
    if not handle.accepted:
        print('Goal was rejected.')
        return
    print(f'Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n')
    ending = handle.get_result_async()
    try:
        if not graph.spin_until(ending.done, timeout_sec=limit_sec):
            _cancel(graph, handle)
            raise CommandError(f'The goal has not ended after waiting {limit_sec} seconds.')
        result = _answer(graph, ending, 'getting result')
    except Stopped as stopped:
        if not stopping.resume_after(stopped) or _has_ended(handle):
            raise
        _cancel(graph, handle)
        result = _answer(graph, ending, 'getting result')
    print(f'Result:\n    {completion.fields_as_yaml(result.result)}')
    print(f'Goal finished with status: {_status_name(result.status)}')


def _show_feedback(message: Any) -> None:
    print(f'Feedback:\n    {completion.fields_as_yaml(message.feedback)}')


def _answer(graph: Graph, future: Any, doing: str, *, limit_sec: float = math.inf) -> Any:
    if not graph.spin_until(future.done, timeout_sec=limit_sec):
        raise CommandError(f'No answer while {doing} after waiting {limit_sec} seconds.')
    if (answer := future.result()) is None:
        raise CommandError(f'Exception while {doing}: {future.exception()!r}')
    return answer


def _has_ended(handle: Any) -> bool:
    """Whether the goal has ended, or another client is cancelling it."""
    from action_msgs.msg import GoalStatus

    return handle.status not in (
        *(GoalStatus.STATUS_UNKNOWN, GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING),
    )


def _cancel(graph: Graph, handle: Any) -> None:
    print('Canceling goal...')
    response = _answer(graph, handle.cancel_goal_async(), 'canceling goal')
    cancelled = [info.goal_id for info in response.goals_canceling]
    if not cancelled:
        raise CommandError('Failed to cancel goal')
    if len(cancelled) > 1:
        raise CommandError('More than one goal canceled')
    if cancelled[0] != handle.goal_id:
        raise CommandError('Canceled goal with incorrect goal ID')
    print('Goal canceled.')


def _status_name(status: int) -> str:
    from action_msgs.msg import GoalStatus

    names = 'ACCEPTED', 'EXECUTING', 'CANCELING', 'SUCCEEDED', 'CANCELED', 'ABORTED'
    return {getattr(GoalStatus, f'STATUS_{name}'): name for name in names}.get(status, 'UNKNOWN')
