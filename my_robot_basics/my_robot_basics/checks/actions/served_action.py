"""The check's own action server, and the outcomes that a client publishes of its goals."""

from collections.abc import Callable
from typing import Any

from std_msgs.msg import Bool

from my_robot_basics.checks.actions import goal_senders
from my_robot_basics.checks.actions.client_nodes import ClientNodes
from my_robot_basics.checks.actions.scripted_action import ReceivedGoal, ScriptedActionServer
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph.watcher import Watcher

REPLY_SEC, AGAIN_SEC = 4.0, 1.0
"""How long to wait for a goal, a request to cancel or an outcome, in s of free time. A new client
may lose a goal, so its message is published again after AGAIN_SEC."""
QUIET_SEC, SOON_SEC, MORE_SEC = 0.5, 0.25, 0.05
"""How long to wait for what must not come, in s of wall time: normally; if the node has already
processed everything; for a second message of a callback that has published one."""


class ServedAction(ScriptedActionServer):
    """The server that `action_server` yields, for the duration of its with statement."""

    def __init__(
        self,
        watcher: Watcher,
        *,
        name: str,
        type_: type,
        asked_on: str,
        cancelled_on: str,
        outcomes: Recorder,
    ) -> None:
        super().__init__(watcher.node, name=name, type_=type_)
        self.asked_on, self.cancelled_on = asked_on, cancelled_on
        self.watcher, self._outcomes = watcher, outcomes
        self.client = ClientNodes(watcher, outcomes)
        self.may_sleep = True
        """Whether a callback may sleep while the check waits for a goal or an outcome."""
        self._known_starts = self._before = 0
        self.asked = goal_senders.AskedGoals(asked_on, cancelled_on)
        self._for_last: Callable[[], list[ReceivedGoal]] = list  # the goals for the last message
        self._was_away = False  # whether a message without a goal so far found no server
        self._cancelled_sec = 0.0  # the longest time from a goal to an obstacle's cancel request

    def publish(self, message: Any) -> None:
        """Publish a message that should lead to a goal, without waiting for the goal."""
        self._was_away = self._was_away or self._server is None
        self.asked.messages.append(message)
        self.client.publish(self.asked_on, message)

    def ask(
        self, message: Any, *, is_it: Callable[[Any], bool], hint: Callable[[Any], str]
    ) -> ReceivedGoal:
        """Publish a message on `asked_on`; return the goal to which it leads.

        That is the first new goal for which `is_it` holds. `hint(request)` says what is wrong with
        another goal. Raises CheckFailed with the reason.
        """
        self.is_expected = is_it
        if self._known_starts < self.starts:
            goal_senders.meet_client(self.watcher, self.name)
        before, self._before = len(self.goals), len(self._outcomes.received)

        def found() -> list[ReceivedGoal]:
            return [goal for goal in self.goals[before:] if is_it(goal.request)]

        self.publish(message)
        self._for_last = found
        free_sec = AGAIN_SEC if self._known_starts < self.starts else REPLY_SEC
        for _ in range(round(REPLY_SEC / free_sec)):
            if self.client.comes_in_time(
                lambda: bool(found()), free_sec, may_sleep=self.may_sleep
            ):
                self._known_starts, self._was_away = self.starts, False
                self.let_client_know()
                return found()[0]
            if self._known_starts < self.starts and self._is_lost(before):
                self.publish(message)
                self._for_last = list  # a client that is slow may send one goal for each
        others, name = self.goals[before:], self.name
        fail(
            expected=f'a goal for {name} for the message on {self.asked_on}',
            seen=shorten(others[-1].request) if others else f'none in {REPLY_SEC:g} s',
            hint=hint(others[-1].request) if others else self._why_no_goal(),
            cause=f'{name} is sent another goal' if others else f'{name} is sent no goal',
        )

    def say_obstacle(self, is_there: bool) -> None:
        """Publish on `cancelled_on` whether there is an obstacle."""
        self._before, self.asked.is_obstacle = len(self._outcomes.received), is_there
        self.client.publish(self.cancelled_on, Bool(data=is_there))

    def expect_cancel_of(self, goal: ReceivedGoal) -> None:
        """The client cancels that goal for True on `cancelled_on`. Raises CheckFailed."""
        self.client.answering()  # once more: it may have answered before it knew of its goal
        self.say_obstacle(is_there=True)
        is_late = bool(self.client.mute)  # for a reason that other checks tell
        for _ in range(round(REPLY_SEC / AGAIN_SEC)):
            if self.client.comes_in_time(lambda: bool(goal.cancels), AGAIN_SEC, may_sleep=is_late):
                self._cancelled_sec = max(self._cancelled_sec, goal.cancelled_sec())
                return
            # the message may have arrived before the client knew that its goal was accepted
            self.client.publish(self.cancelled_on, Bool(data=True))
        goal_senders.expect_one(self._for_last(), asked_on=self.asked_on)
        how = goal_senders.how_to_cancel(self.watcher, goal, self.goals, say=self.say_obstacle)
        fail(
            expected=f'a request to cancel the goal for True on {self.cancelled_on}',
            seen=f'none in {REPLY_SEC:g} s',
            hint=self._why_silent(how),
            cause='the goal is not cancelled',
        )

    def is_cancelled(self, goal: ReceivedGoal, *, soon: bool) -> bool:
        """Whether the client cancels the goal soon, or later than any such request so far."""
        quiet_sec = SOON_SEC if soon else QUIET_SEC + 1.5 * self._cancelled_sec
        return self.watcher.spin_until(lambda: bool(goal.cancels), timeout_sec=quiet_sec)

    def expect_outcome(self, word: str, *, hint: Callable[[str], str]) -> None:
        """The client publishes that word once; `hint(seen)` is for others. Raises CheckFailed."""

        def new() -> list[str]:
            return [message.data for message in self._outcomes.messages()[self._before :]]

        if self.client.comes_in_time(lambda: word in new(), REPLY_SEC, may_sleep=self.may_sleep):
            self.client.raised.expect_none()
            self.watcher.spin_for(MORE_SEC)
            goal_senders.expect_one(self._for_last(), asked_on=self.asked_on)
            expect(
                len(new()) == 1 or len(self._outcomes.received) <= self.count_over(),
                expected=f"one outcome of a goal, '{word}', on {self._outcomes.topic_name}",
                seen=student_text(shorten(new())),
                hint='publish one word for each goal: that for the status of its result',
                cause='several outcomes of one goal are published',
            )
            return
        others, none = new(), f'none in {REPLY_SEC:g} s'
        fail(
            expected=f"'{word}' on {self._outcomes.topic_name}",
            seen=f"'{student_text(shorten(others[-1]))}'" if others else none,
            hint=hint(others[-1]) if others else self._why_silent(hint('')),
            cause='another outcome is published' if others else 'no outcome is published',
        )

    def forget_outcomes(self) -> None:
        """Wait for the outcomes of earlier goals, and ignore them from now on."""
        self.watcher.spin_for(QUIET_SEC)
        self._before = len(self._outcomes.received)

    def expect_no_outcome(self, while_: str) -> None:
        """The client publishes nothing for a while. Raises CheckFailed; `while_` says why."""
        self.let_client_know()
        self.watcher.spin_for(SOON_SEC)
        others = [message.data for message in self._outcomes.messages()[self._before :]]
        expect(
            not others or len(self._outcomes.received) <= self.count_over(),
            expected=f'no outcome while {while_}',
            seen=f"'{student_text(shorten(others[-1]))}'" if others else '',
            hint='publish the outcome when the result is there: its status tells how it ended',
            cause='an outcome is published too soon',
        )
        self.client.raised.expect_none()

    def close(self) -> None:
        """Abort goals that have not ended, and destroy the server."""
        self.client.answering()  # what a late client still does belongs to this check
        for goal in self.goals:
            if not goal.end.done():
                goal.finish('aborted')
        self.watcher.spin_for(0.1)
        self.stop()

    def let_client_know(self) -> None:
        """Wait until the client has processed what was sent before. Raises CheckFailed."""
        self.client.answering(may_sleep=self.may_sleep)
        self.watcher.spin_for(SOON_SEC if self.client.mute else 0.0)
        goal_senders.expect_one(self._for_last(), asked_on=self.asked_on)
        self.asked.expect_no_others(self.goals)

    def _is_lost(self, before: int) -> bool:
        """Whether no goal comes beyond the first `before`, even if the client is late."""
        self.client.answering()
        late_sec = AGAIN_SEC if self.client.mute else 0.0
        return not self.watcher.spin_until_free(
            lambda: len(self.goals) > before, free_sec=late_sec
        )

    def _why_no_goal(self) -> str:
        how = {'asked': self.asked, 'was_away': self._was_away, **self._client_state()}
        return goal_senders.why_no_goal(self.watcher, self.name, self.type, **how)

    def _why_silent(self, hint: str) -> str:
        return goal_senders.why_silent(self.watcher, hint, **self._client_state())

    def _client_state(self) -> dict[str, Any]:
        return {'node_names': self._outcomes.publishers(), 'raised': self.client.raised}
