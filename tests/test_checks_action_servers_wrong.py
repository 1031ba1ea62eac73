"""For a node that sends goals and has one mistake, the check names the cause."""

import threading
import time

import pytest
import rclpy
from goal_clients import ENDS, WORDS, MoveArmClient, check_cancels, check_outcomes
from my_robot_basics.checks import CheckFailed, action_server, replies
from my_robot_basics.checks.actions import served_action
from nodes.running import STOPS
from rclpy.action import ActionClient
from sensor_msgs.msg import JointState

from arm_interfaces.action import MoveArm


@pytest.fixture
def impatient(monkeypatch):
    """Shorten the waits for messages that never come."""
    monkeypatch.setattr(served_action, 'REPLY_SEC', 2.0)


# --- wrong outcomes ------------------------------------------------------------------------------


class AlwaysSucceeded(MoveArmClient):
    def ended(self, future):
        self.goal_handle = None
        self.tell('succeeded')


class IgnoresRejection(MoveArmClient):
    def answered(self, future):
        if future.result().accepted:
            super().answered(future)


class AsksTheRejectedOne(MoveArmClient):
    def answered(self, future):
        future.result().get_result_async().add_done_callback(self.ended)

    def ended(self, future):
        self.tell(WORDS.get(future.result().status, 'aborted'))


class TellsAtOnce(MoveArmClient):
    def answered(self, future):
        self.tell('succeeded' if future.result().accepted else 'rejected')
        self.goal_handle = future.result()


class Numbers(MoveArmClient):
    def ended(self, future):
        self.tell(str(future.result().status))


class Capitals(MoveArmClient):
    def tell(self, word):
        super().tell(word.upper())


class AllWordsAtOnce(MoveArmClient):
    """Publishes each word for each goal that ended: one of them is right."""

    def ended(self, future):
        for word in ('succeeded', 'canceled', 'aborted'):
            self.tell(word)


class NoResult(MoveArmClient):
    def answered(self, future):
        if not future.result().accepted:
            self.tell('rejected')


class Degrees(MoveArmClient):
    def send(self, pose):
        pose.position = [57.29577951 * each for each in pose.position]
        super().send(pose)


class OtherSpeed(MoveArmClient):
    def send(self, pose):
        goal = MoveArm.Goal(position=pose.position, speed=1.0)
        self.client.send_goal_async(goal).add_done_callback(self.answered)


class CancelsNone(MoveArmClient):
    def obstacle(self, message):
        if message.data:
            self.goal_handle.cancel_goal_async()


class Raises(MoveArmClient):
    def ended(self, future):
        self.tell(WORDS[future.result().status_of_the_goal])


class SendsAndWaits(MoveArmClient):
    def send(self, pose):
        future = self.client.send_goal_async(MoveArm.Goal(position=pose.position, speed=0.5))
        rclpy.spin_until_future_complete(self, future, timeout_sec=20.0)
        self.answered(future)


class Sleeps(MoveArmClient):
    def send(self, pose):
        future = self.client.send_goal_async(MoveArm.Goal(position=pose.position, speed=0.5))
        is_over = threading.Event()
        STOPS.append(is_over.set)
        while not future.done() and not is_over.wait(0.05):
            pass


class SleepsBeforeItSends(MoveArmClient):
    def send(self, pose):
        time.sleep(2.0)
        super().send(pose)


class SleepsBeforeItTells(MoveArmClient):
    def ended(self, future):
        time.sleep(2.0)
        super().ended(future)


class OtherAction(MoveArmClient):
    def __init__(self):
        super().__init__()
        self.client.destroy()
        self.client = ActionClient(self, MoveArm, '/move_it')


class NeverSends(MoveArmClient):
    def send(self, pose):
        pass


class SendsTwice(MoveArmClient):
    """The arm would move twice, if its server were not busy with the first goal."""

    def send(self, pose):
        self.client.send_goal_async(MoveArm.Goal(position=pose.position, speed=0.5))
        super().send(pose)


class TriesAgain(MoveArmClient):
    """Sends a rejected goal a second time, when everybody has been told of the first."""

    def send(self, pose):
        self.pose = pose
        super().send(pose)

    def tell(self, word):
        super().tell(word)
        if word == 'rejected':
            super().send(self.pose)


class WaitsForTheServer(MoveArmClient):
    """Waits in the callback until there is a server, but for no response."""

    def send(self, pose):
        self.client.wait_for_server()
        super().send(pose)


class WaitsForTheLost(MoveArmClient):
    """Sends one goal after the other, but the first one reaches no server."""

    def __init__(self):
        super().__init__()
        self.poses = []

    def send(self, pose):
        self.poses.append(pose)
        if len(self.poses) == 1:
            super().send(pose)

    def tell(self, word):
        super().tell(word)
        self.poses.pop(0)
        if self.poses:
            super().send(self.poses[0])


IN_CALLBACK = 'it waits inside a callback, and no answer is delivered meanwhile: use send_goal_asy'
ASLEEP = r'it sleeps inside a callback \(line \d+: time.sleep\(2.0\)\), and no other callback runs'

WRONG_OUTCOMES = [
    (CancelsNone, "'NoneType' object has no attribute 'cancel_goal_async'.* in obstacle"),
    (
        AlwaysSucceeded,
        r"expected 'aborted' on .*saw 'succeeded': publish the outcome when the res",
    ),
    (
        IgnoresRejection,
        "expected 'rejected' on .*saw none.*: a goal that is not accepted has no r",
    ),
    (
        AsksTheRejectedOne,
        "expected 'rejected' on .*saw 'aborted': a goal that is not accepted has",
    ),
    (TellsAtOnce, "no outcome while the goal has not ended, saw 'succeeded': publish the outcome"),
    (Numbers, "expected 'succeeded' on .*saw '4': publish the word for the status, not its num"),
    (Capitals, "expected 'succeeded' on .*saw 'SUCCEEDED': write the word in lower case"),
    (AllWordsAtOnce, "one outcome of a goal, 'succeeded', on .*publish one word for each goal"),
    (
        NoResult,
        "expected 'succeeded' on .*saw none.*: publish the outcome when the result is ther",
    ),
    (Degrees, 'put the positions of the pose into goal.position, as they are: in radians'),
    (OtherSpeed, 'saw .*speed=1.0.*: give each goal the speed that the task names'),
    (Raises, r"expected 'succeeded' on .*its callback raised AttributeError.*; fix that first"),
    (SendsAndWaits, IN_CALLBACK),
    (Sleeps, IN_CALLBACK),
    (SleepsBeforeItSends, ASLEEP),
    (SleepsBeforeItTells, ASLEEP),
    (OtherAction, '/move_arm_client uses /move_it, so compare the spelling'),
    (NeverSends, r'expected a goal .*saw none.*: call send_goal_async\(goal\) for each message'),
    (SendsTwice, r'one goal for each message on /goal_pose, saw 2 .*: call send_goal_async\('),
    (TriesAgain, r'one goal for each message on /goal_pose, saw \d+ for one message: call send_'),
    (
        WaitsForTheServer,
        'a node that goes on with its work while there is no server .*: look at server_is_ready',
    ),
    (WaitsForTheLost, 'a goal that is sent while there is no server never gets an answer'),
]


@pytest.mark.parametrize(('node_class', 'message'), WRONG_OUTCOMES)
@pytest.mark.usefixtures('impatient')
def test_a_wrong_outcome_fails_with_its_cause(run, node_class, message):
    run(node_class)
    with pytest.raises(CheckFailed, match=message):
        check_outcomes()


class OnlyNewWords(MoveArmClient):
    last = ''

    def tell(self, word):
        if word != self.last:
            super().tell(word)
        self.last = word


@pytest.mark.usefixtures('impatient')
def test_a_client_that_does_not_repeat_an_outcome_is_told_so(run):
    run(OnlyNewWords)
    with action_server('/move_arm', MoveArm, **ENDS) as server:
        replies.expect_outcomes(server, succeeded=(1.2, -0.6))
        with pytest.raises(CheckFailed, match=r'saw none.* also if it equals the last one'):
            replies.expect_outcomes(server, succeeded=(1.2, -0.6))


# --- wrong at obstacles --------------------------------------------------------------------------


class CancelsForFalse(MoveArmClient):
    def obstacle(self, message):
        message.data = True
        super().obstacle(message)


class CancelsForFalseAlone(MoveArmClient):
    def obstacle(self, message):
        message.data = not message.data
        super().obstacle(message)


class CancelsForNewObstacles(MoveArmClient):
    """Ignores True if the message before it was True, too."""

    is_there = False

    def obstacle(self, message):
        is_new, self.is_there = message.data and not self.is_there, message.data
        message.data = is_new
        super().obstacle(message)


class CancelsByTheClock(MoveArmClient):
    """Cancels each goal some time after it was accepted, whatever is on `/obstacle`."""

    def answered(self, future):
        super().answered(future)
        if future.result().accepted:
            timer = threading.Timer(1.0, future.result().cancel_goal_async)
            timer.start()
            STOPS.append(timer.cancel)

    def obstacle(self, message):
        pass


class RemembersTheObstacle(MoveArmClient):
    is_there = False

    def answered(self, future):
        super().answered(future)
        if future.result().accepted and self.is_there:
            future.result().cancel_goal_async()

    def obstacle(self, message):
        self.is_there = message.data
        super().obstacle(message)


class SleepsBeforeItCancels(MoveArmClient):
    def obstacle(self, message):
        if message.data and self.goal_handle is not None:
            time.sleep(2.0)
        super().obstacle(message)


class NeverCancels(MoveArmClient):
    def obstacle(self, message):
        pass


class TellsBeforeTheServer(MoveArmClient):
    def obstacle(self, message):
        if message.data and self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()
            self.tell('canceled')


class KeepsTheRejectedOne(MoveArmClient):
    def answered(self, future):
        super().answered(future)
        self.goal_handle = future.result()


class Retreats(MoveArmClient):
    """Sends the arm home by itself when there is an obstacle."""

    def obstacle(self, message):
        if message.data and self.goal_handle is not None:
            self.send(JointState(position=[0.0, 0.0]))
        super().obstacle(message)


class WritesTwoLs(MoveArmClient):
    def tell(self, word):
        super().tell('cancelled' if word == 'canceled' else word)


class BlindToObstacles(MoveArmClient):
    def create_subscription(self, type_, name, *arguments):
        name = '/obstacles' if name == '/obstacle' else name
        return super().create_subscription(type_, name, *arguments)


WRONG_CANCELS = [
    (
        CancelsForFalse,
        'no request to cancel the goal for False .*: look at message.data: only Tru',
    ),
    (CancelsForFalseAlone, 'a request to cancel .*saw none.*: look at message.data: only True'),
    (CancelsForNewObstacles, 'a request to cancel .*saw none.*: each True cancels the goal that'),
    (CancelsByTheClock, 'no request to cancel .*, saw one'),
    (
        RemembersTheObstacle,
        'after True .*: an obstacle cancels the goal that moves the arm then, and no',
    ),
    (SleepsBeforeItCancels, ASLEEP),
    (
        NeverCancels,
        r'expected a request to cancel .*saw none.*: call cancel_goal_async\(\) of the',
    ),
    (TellsBeforeTheServer, "no outcome while the server has not said.*, saw 'canceled': publish"),
    (
        Retreats,
        r'no goal but those for the messages on /goal_pose, saw .*: send a goal in the cal',
    ),
    (KeepsTheRejectedOne, r'expected a request to cancel .*saw none'),
    (WritesTwoLs, "expected 'canceled' on .*saw 'cancelled': write canceled with one l"),
    (BlindToObstacles, '/move_arm_client uses /obstacles, so compare the spelling'),
]


@pytest.mark.slow
@pytest.mark.parametrize(('node_class', 'message'), WRONG_CANCELS)
@pytest.mark.usefixtures('impatient')
def test_a_wrong_cancel_fails_only_the_check_of_cancels(run, node_class, message):
    run(node_class)
    check_outcomes()
    with pytest.raises(CheckFailed, match=message):
        check_cancels()
