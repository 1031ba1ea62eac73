"""The nodes of an action client: send them messages, ask whether they answer, sleep or raise."""

from collections.abc import Callable
from typing import Any

from rclpy.publisher import Publisher

from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.services import late_answers
from my_robot_basics.checks.services.services import LATE_SEC, answers_parameters
from my_robot_basics.checks.services.waiting_clients import sleeping_call, sleeps
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.watcher import Watcher


class ClientNodes:
    """The nodes that publish what becomes of their goals."""

    def __init__(self, watcher: Watcher, outcomes: Recorder) -> None:
        self._watcher, self._outcomes = watcher, outcomes
        self.raised = CallbackErrors(set(outcomes.publishers()))
        self.mute: set[str] = set()
        """Full names of nodes that gave no answer about parameters: they are not asked again."""
        self.publishers: dict[str, Publisher] = {}
        """The check's publishers, by topic."""

    def publish(self, topic_name: str, message: Any) -> None:
        """Publish a message as soon as a node subscribes to the topic."""
        if topic_name not in self.publishers:
            self.publishers[topic_name] = Topic(topic_name).meet(self._watcher, type(message))
        self.publishers[topic_name].publish(message)

    def told(self) -> str:
        """The last outcome so far, or ''."""
        return next((message.data for message in reversed(self._outcomes.messages())), '')

    def answering(self, *, may_sleep: bool = True) -> set[str]:
        """Full names of the nodes whose parameter services have always answered, also now.

        Raises CheckFailed if a node answers late and sleeps, unless it `may_sleep`.
        """
        names = {*self._outcomes.publishers()} - self.mute
        when_late = None if may_sleep else self.expect_awake
        self.mute |= {
            name
            for name in names
            if not answers_parameters(self._watcher, name, when_late=when_late)
        }
        return names - self.mute

    def comes_in_time(self, done: Callable[[], bool], free_sec: float, *, may_sleep: bool) -> bool:
        """Spin until `done()`, as `late_answers.comes_in_time`; return whether it is done.

        Raises CheckFailed if that takes LATE_SEC and a node sleeps, unless it `may_sleep`.
        """
        if not may_sleep and not self._watcher.spin_until(done, timeout_sec=LATE_SEC):
            self.expect_awake()
        names = self._outcomes.publishers()
        return late_answers.comes_in_time(self._watcher, done, free_sec=free_sec, names=names)

    def expect_awake(self) -> None:
        """No callback sleeps, as the notebook reports within a second. Raises CheckFailed.

        Call it only after a wait in vain: then a node that sleeps has admitted what delays it, and
        a busy machine makes no difference.
        """
        for name in sorted(self._outcomes.publishers()):
            if call := sleeping_call(node_troubles.blocking_line(name)):
                fail(
                    expected='a node that goes on with its work at any time',
                    seen='that it sleeps',
                    hint=sleeps(student_text(call)),
                    cause='the node sleeps inside a callback',
                )
