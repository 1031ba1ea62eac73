"""The check's own server of an action, for a node of the student's that sends it goals."""

from collections.abc import Iterator
from contextlib import contextmanager

from std_msgs.msg import String

from my_robot_basics.checks.served_action import ServedAction
from my_robot_basics.checks.topics import Topic
from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import actions
from my_robot_basics.graph.watcher import Watcher


@contextmanager
def action_server(
    name: str, type_: type, *, asked_on: str, to: str, cancelled_on: str, starts: bool = True
) -> Iterator[ServedAction]:
    """The check's own server of an action, for the duration of a with statement.

    The student's node sends a goal for each message on the topic `asked_on`, asks to cancel it for
    True on `cancelled_on`, and publishes on `to` (String) how it ended. Without `starts`, the
    server is absent until `server.start()`. Raises CheckFailed where nobody publishes on `to`,
    or anything but a String, or another node serves.

        with action_server('/move_arm', MoveArm, asked_on='/goal_pose',
                           to='/move_arm_client/outcome', cancelled_on='/obstacle') as server:
            goal = server.ask(pose, is_it=lambda request: request.speed == 0.5)
            server.expect_no_outcome('the goal has not ended')
            goal.finish('succeeded')
            server.expect_outcome('succeeded')
    """
    with Watcher(shared=True) as watcher:
        outcomes = Topic(to).listen(watcher, type_=String)
        others = actions.take(watcher.node).servers.get(name, {})
        expect(
            not others,
            expected=f'no server of the action {name} but that of this check',
            seen=theirs(', '.join(sorted(others))),
            hint='stop that node: here, the check itself serves',
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
