"""The picture of a goal: the states that it has been through, its feedback, and the arm."""

import math
import time
from io import BytesIO
from itertools import pairwise

import matplotlib.image
import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from builtin_interfaces.msg import Time
from my_robot_basics.drawing.goal import NOT_YET, NOW, REACHED
from my_robot_basics.live import run, stop, wait_until
from my_robot_basics.live.pictures.goal_view import GoalFollower, GoalView
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from unique_identifier_msgs.msg import UUID

from arm_interfaces.action import MoveArm

FIRST, SECOND = UUID(uuid=[1] * 16), UUID(uuid=[2] * 16)
NEVER_SEEN = '/move_arm: waiting for a goal'


@pytest.fixture
def view():
    return GoalView('/move_arm', l1=1.0, l2=0.8)


def statuses(**states):
    """A list of two goals, the first of which was sent first."""
    ids = {'first': (FIRST, 1), 'second': (SECOND, 2)}
    message = GoalStatusArray()
    for name, state in states.items():
        goal_id, sec = ids[name]
        info = GoalInfo(goal_id=goal_id, stamp=Time(sec=sec))
        status = getattr(GoalStatus, f'STATUS_{state}')
        message.status_list.append(GoalStatus(goal_info=info, status=status))
    return message


def feedback(goal_id, remaining, *position):
    inner = MoveArm.Feedback(position=position, remaining=remaining)
    return MoveArm.Impl.FeedbackMessage(goal_id=goal_id, feedback=inner)


def words(view):
    return view._bundle()['text/plain'].removeprefix('goal of ')


PATHS = {
    'ACCEPTED': 'ACCEPTED',
    'EXECUTING': 'ACCEPTED → EXECUTING',
    'SUCCEEDED': 'ACCEPTED → EXECUTING → SUCCEEDED',
    'ABORTED': 'ACCEPTED → EXECUTING → ABORTED',
    'CANCELING': 'ACCEPTED → EXECUTING → CANCELING',
    'CANCELED': 'ACCEPTED → EXECUTING → CANCELING → CANCELED',
}


@pytest.mark.parametrize('state', PATHS)
def test_a_goal_state_is_shown_with_the_states_before_it(view, state):
    assert words(view) == NEVER_SEEN
    view.take_status(statuses(first=state))
    assert words(view) == f'/move_arm: {PATHS[state]}'
    faces = {name: box.get_bbox_patch() for name, box in view._picture._boxes.items()}
    *before, _ = PATHS[state].split(' → ')
    for name, patch in faces.items():
        face = NOW if name == state else REACHED if name in before else NOT_YET
        assert patch.get_facecolor() == matplotlib.colors.to_rgba(face)


def test_a_goal_that_was_being_cancelled_may_succeed(view):
    view.take_status(statuses(first='CANCELING'))
    view.take_status(statuses(first='SUCCEEDED'))
    assert words(view) == '/move_arm: ACCEPTED → EXECUTING → CANCELING → SUCCEEDED'


def test_the_newest_goal_is_shown(view):
    view.take_status(statuses(first='EXECUTING'))
    view.take_feedback(feedback(FIRST, 0.4, 0.1, 0.2))
    view.take_status(statuses(second='ACCEPTED', first='SUCCEEDED'))
    assert words(view) == '/move_arm: ACCEPTED'


def test_feedback_moves_the_arm_and_the_bar(view):
    view.take_status(statuses(first='EXECUTING'))
    for count, remaining in enumerate((0.8, 0.2), start=1):
        view.take_feedback(feedback(FIRST, remaining, 0.5, -1.0))
        told = f'feedback {count}: {remaining:.2f} rad remain'
        assert words(view) == f'/move_arm: ACCEPTED → EXECUTING, {told}'
    assert view._pose == pytest.approx((math.degrees(0.5), math.degrees(-1.0)))
    assert view._picture._bar.get_width() == pytest.approx(8.0 * 0.6 / 0.8)
    assert view._picture._remaining.get_text() == told


@pytest.mark.parametrize(
    ('remaining', 'done'), [([], 0.0), ([0.8], 0.0), ([0.8, 0.0], 1.0), ([0.0], 1.0)]
)
def test_the_bar_fills_from_the_left_until_the_arm_is_there(view, remaining, done):
    view.take_status(statuses(first='EXECUTING'))
    for each in remaining:
        view.take_feedback(feedback(FIRST, each, 0.5, -1.0))
    words(view)
    assert view._picture._bar.get_x() == 1.0
    assert view._picture._bar.get_width() == pytest.approx(8.0 * done)


@pytest.mark.parametrize('position', [(), (0.1,), (0.1, math.nan), (0.1, 0.2, 0.3)])
def test_feedback_that_gives_no_pose_is_not_drawn(view, position):
    view.take_feedback(feedback(FIRST, 0.8, *position))
    assert words(view) == NEVER_SEEN


def test_no_state_is_filled_in_before_a_goal_is_known(view):
    view.take_status(GoalStatusArray())
    view._bundle()
    boxes = view._picture._boxes.values()
    assert {box.get_bbox_patch().get_facecolor() for box in boxes} == {(1.0, 1.0, 1.0, 1.0)}


def test_the_goal_picture_fits_a_phone_and_its_texts_do_not_overlap(view):
    view.take_status(statuses(first='CANCELED'))
    picture = matplotlib.image.imread(BytesIO(view._bundle()['image/png']))
    assert picture.shape[1] <= 400
    renderer = view._picture._canvas.get_renderer()
    texts = [*view._picture._boxes.values(), view._picture._remaining]
    frames = [text.get_window_extent(renderer) for text in texts if text.get_text()]
    for one, other in pairwise(sorted(frames, key=lambda frame: frame.x0)):
        assert not one.overlaps(other)


class Quick(Node):
    def __init__(self):
        super().__init__('quick')
        ActionServer(self, MoveArm, '/quick', self.execute)

    def execute(self, goal_handle):
        goal_handle.publish_feedback(MoveArm.Feedback(position=[0.5, 0.0], remaining=0.5))
        goal_handle.succeed()
        return MoveArm.Result()


@pytest.mark.slow
@pytest.mark.starts
def test_the_view_shows_states_and_feedback_of_a_running_action():
    view = GoalView('/quick', l1=1.0, l2=0.8)
    run(Quick)
    run(GoalFollower, '_follower', '/quick', view)
    user = run(Node, 'user')
    client = ActionClient(user, MoveArm, '/quick')
    try:
        wait_until(lambda: user.count_subscribers('/quick/_action/feedback') == 2, 20.0)
        client.wait_for_server(20.0)
        client.send_goal_async(MoveArm.Goal())
        expected = f'/quick: {PATHS["SUCCEEDED"]}, feedback 1: 0.50 rad remain'
        wait_until(lambda: words(view) == expected, 20.0)
    finally:
        stop()


class Steps(Node):
    def __init__(self):
        super().__init__('steps')
        ActionServer(self, MoveArm, '/steps', self.execute)

    def execute(self, goal_handle):
        for left in (0.4, 0.3, 0.2, 0.1, 0.0):
            feedback = MoveArm.Feedback(position=[0.4 - left, 0.0], remaining=left)
            goal_handle.publish_feedback(feedback)
        goal_handle.succeed()
        return MoveArm.Result()


@pytest.mark.starts
def test_the_last_picture_has_all_feedback_if_the_cell_stops_at_the_result(monkeypatch):
    view = GoalView('/steps', l1=1.0, l2=0.8)
    take = view.take_feedback

    def take_slowly(message):
        time.sleep(0.1)
        take(message)

    monkeypatch.setattr(view, 'take_feedback', take_slowly)
    run(Steps)
    run(GoalFollower, '_follower', '/steps', view)
    user = run(Node, 'user')
    client = ActionClient(user, MoveArm, '/steps')
    try:
        wait_until(lambda: user.count_subscribers('/steps/_action/feedback') == 2, 20.0)
        client.wait_for_server(20.0)
        sent = client.send_goal_async(MoveArm.Goal())
        wait_until(sent.done, 20.0)
        wait_until(sent.result().get_result_async().done, 20.0)
    finally:
        stop()
    assert words(view) == f'/steps: {PATHS["SUCCEEDED"]}, feedback 5: 0.00 rad remain'
