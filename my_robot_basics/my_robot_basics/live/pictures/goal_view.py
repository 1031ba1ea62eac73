"""A picture of the states of an action's goal, and of the arm that it moves, updated live."""

import math
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.goal import PLACES, GoalPicture
from my_robot_basics.live.nodes import runner
from my_robot_basics.live.pictures.follow import ArmView
from my_robot_basics.two_link_kinematics import L1, L2

NAMES = {getattr(GoalStatus, f'STATUS_{state}'): state for state in PLACES}
"""The state's name for each status number."""
BEFORE = {
    'EXECUTING': ('ACCEPTED',),
    'CANCELING': ('ACCEPTED', 'EXECUTING'),
    'SUCCEEDED': ('ACCEPTED', 'EXECUTING'),
    'ABORTED': ('ACCEPTED', 'EXECUTING'),
    'CANCELED': ('ACCEPTED', 'EXECUTING', 'CANCELING'),
}
"""States that a goal must have been in before, even if no message showed it: a new subscription
receives only the newest list of states."""


def follow_goal(action_name: str = '/move_arm', *, l1: float = L1, l2: float = L2) -> None:
    """Show the newest goal of a MoveArm action: its states, its feedback, the arm, until `stop()`.

    The picture is updated in place, a few times a second, after the cell has returned. It sends no
    request: states and feedback come from two topics of the action. Link lengths are in metres.
    """
    view = GoalView(action_name, l1=l1, l2=l2)
    node_name = '_follow_goal' + ''.join(c if c.isalnum() else '_' for c in action_name)
    runner.launch(
        GoalFollower,
        (node_name, action_name, view),
        {},
        key=node_name,
        make_panel=lambda: view,
    )
    view.publish()


class GoalFollower(Node):
    """Passes on what an action's server publishes about its goals."""

    def __init__(self, node_name: str, action_name: str, view: 'GoalView') -> None:
        """Subscribe to the action's two topics."""
        from arm_interfaces.action import MoveArm

        super().__init__(node_name, enable_rosout=False, start_parameter_services=False)
        status_qos = qos_profile_action_status_default
        topics = f'{action_name}/_action'
        self.create_subscription(GoalStatusArray, f'{topics}/status', view.take_status, status_qos)
        feedback_type = MoveArm.Impl.FeedbackMessage
        self.create_subscription(feedback_type, f'{topics}/feedback', view.take_feedback, 10)

    def destroy_node(self) -> None:
        """Take what has arrived, then end: a cell calls `stop()` as soon as it has the result.

        Otherwise the last picture of a goal that has SUCCEEDED may show the arm on its way.
        """
        for subscription in self.subscriptions:
            with subscription.handle:
                while taken := subscription.handle.take_message(subscription.msg_type, False):
                    subscription.callback(taken[0])
        super().destroy_node()


class GoalView(ArmView):
    """The state of one goal, and its picture."""

    _make_picture = GoalPicture
    _picture: GoalPicture

    def __init__(self, action_name: str, *, l1: float, l2: float) -> None:
        """Begin without a goal."""
        super().__init__(action_name, l1=l1, l2=l2)
        self._trouble = gettext_noop('waiting for a goal')
        self._goal_id = b''
        self._states: list[str] = []
        self._feedback_count, self._way, self._left = 0, 0.0, 0.0

    def take_status(self, message: GoalStatusArray) -> None:
        """Take the state of the newest goal on the list."""
        if not message.status_list:
            return
        newest = max(message.status_list, key=lambda status: _stamp(status.goal_info.stamp))
        self._begin(bytes(newest.goal_info.goal_id.uuid))
        if (state := NAMES.get(newest.status)) is not None:
            reached = [*BEFORE.get(state, ()), *self._states, state]
            self._states = sorted(set(reached), key=_ORDER.index)
        self._display.update_soon(self._bundle)

    def take_feedback(self, message: Any) -> None:
        """Show the arm's current pose and how much of the motion is done."""
        feedback = message.feedback
        if len(feedback.position) != 2 or not all(map(math.isfinite, feedback.position)):
            return
        self._begin(bytes(message.goal_id.uuid))
        self._feedback_count += 1
        self._way = max(self._way, feedback.remaining)
        self._left = feedback.remaining
        theta1_deg, theta2_deg = map(math.degrees, feedback.position)
        self._pose = theta1_deg, theta2_deg
        self.received.set()
        self._display.update_soon(self._bundle)

    def _begin(self, goal_id: bytes) -> None:
        """Start over if this is a new goal."""
        if self._goal_id == goal_id:
            return
        self._goal_id, self._trouble = goal_id, ''
        self._states = []
        self._feedback_count, self._way, self._left = 0, 0.0, 0.0

    def _about(self, topic_name: str) -> str:
        return gettext_noop(f'goal of {topic_name}')

    def _done(self) -> float:
        """Which part of the motion is done; a goal to where the arm is has no way to go."""
        if not self._feedback_count:
            return 0.0
        return 1.0 - self._left / self._way if self._way else 1.0

    def _bundle(self) -> dict:
        count = self._feedback_count
        words = gettext_noop(f'feedback {count}: {self._left:.2f} rad remain') if count else ''
        self._picture.states(self._states)
        self._picture.progress(self._done(), words)
        bundle = super()._bundle()
        said = ', '.join(filter(None, [' → '.join(self._states) or self._trouble, words]))
        return bundle | {'text/plain': f'{self._text}: {said}'}


_ORDER = ['ACCEPTED', 'EXECUTING', 'CANCELING', 'SUCCEEDED', 'CANCELED', 'ABORTED']


def _stamp(time: Any) -> tuple[int, int]:
    return time.sec, time.nanosec
