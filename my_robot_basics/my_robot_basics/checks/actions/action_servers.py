"""The check's own action server, for a student's node that sends goals to it."""

from collections.abc import Iterator
from contextlib import contextmanager

from std_msgs.msg import String

from my_robot_basics.checks.actions.served_action import ServedAction
from my_robot_basics.checks.services.sole_server import stop_call
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import actions
from my_robot_basics.graph.watcher import Watcher


@contextmanager
def action_server(
    name: str, type_: type, *, asked_on: str, to: str, cancelled_on: str, starts: bool = True
) -> Iterator[ServedAction]:
    """Run the check's own action server for the duration of a `with` statement.

    The student's node has to send a goal for each message on the topic `asked_on`, to request its
    cancellation when True arrives on `cancelled_on`, and to publish on `to` (String) how it ended.
    With `starts=False`, there is no server until `server.start()`. Raises CheckFailed if no node
    publishes on `to`, if its type is not String, or if another node serves the action.

        with action_server('/move_arm', MoveArm, asked_on='/goal_pose',
                           to='/move_arm_client/outcome', cancelled_on='/obstacle') as server:
            goal = server.ask(pose, is_it=lambda request: request.speed == 0.5)
            server.expect_no_outcome('the goal has not ended')
            goal.finish('succeeded')
            server.expect_outcome('succeeded')
    """
    with Watcher(shared=True) as watcher:
        outcomes = Topic(to).listen(watcher, type_=String)
        others = actions.take_graph(watcher.node).servers.get(name, {})
        expect(
            not others,
            expected=f'no server of the action {name} but that of this check',
            seen=student_text(', '.join(sorted(others))),
            hint=f'stop that node, with {stop_call(others)} in a cell or Ctrl-C in its terminal:'
            ' here, the check itself serves',
            cause=f'another node serves {name}',
        )
        server = ServedAction(
            watcher,
            name=name,
            type_=type_,
            asked_on=asked_on,
            cancelled_on=cancelled_on,
            outcomes=outcomes,
        )
        if starts:
            server.start()
        try:
            yield server
        finally:
            server.close()
