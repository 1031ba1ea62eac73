"""A check's client of an action server: it sends goals and explains why no answer comes."""

from typing import Any, NoReturn

from rclpy.task import Future

from my_robot_basics.checks.actions.action_ends import TERMINAL, ActionEnds, SentGoal
from my_robot_basics.checks.actions.goal_answers import (
    GoalAnswers,
    Identity,
    answers_of,
    note_answer,
)
from my_robot_basics.checks.actions.server_log import ServerLog
from my_robot_basics.checks.clock.parameter_services import nodes_with_services
from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.services.awaited_servers import (
    SERVER_SEC,
    expect_type,
    wait_for_server,
)
from my_robot_basics.checks.services.services import answers_parameters, wait_for_all
from my_robot_basics.feedback.errors import expect, fail
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import actions
from my_robot_basics.graph.watcher import Watcher

REST_SEC = 2.5
"""How long to wait until earlier goals end, and again after canceling them, in s of free time."""
SERVED_SEC, NEW_SEC = 2.0, 0.1
"""How long to wait for the status array, in seconds of free time: SERVED_SEC if the server has
accepted goals of earlier checks, otherwise NEW_SEC."""
RETURN_SEC = 0.2
"""How long an execute callback may take to return once the goal's status is terminal, in seconds
of free time."""
BLOCKED = (
    "the execute callback keeps the node's only thread: wait with `await sleep(self, …)` in place "
    'of time.sleep(…) or rate.sleep(), or use a MultiThreadedExecutor'
)


class OpenAction:
    """The client of one action server, for the duration of a check."""

    def __init__(self, watcher: Watcher, name: str, type_: type) -> None:
        """Create the client; `meet` waits for the server."""
        self.watcher, self.name, self.type = watcher, name, type_
        self.ends = ActionEnds(watcher, name, type_)
        self.node_name = ''  # the full name of the server's node
        self.accepted: list[SentGoal] = []  # oldest first

    def meet(self) -> None:
        """Wait for the only server, and until its earlier goals end. Raises CheckFailed."""
        self.node_name = self._find()
        self.raised = CallbackErrors([self.node_name])
        self.log = ServerLog(self.watcher, self.node_name)
        self.watcher.spin_until(self.ends.is_connected, timeout_sec=SERVER_SEC)
        self.watcher.spin_until_free(
            lambda: bool(self.ends.statuses.received),
            free_sec=SERVED_SEC if self.answers().accepted_ns else NEW_SEC,
        )
        if self.has_active():
            self._wait_for_rest()
        if self.has_active():
            self.ends.cancel_all()
            self._wait_for_rest()

    def has_active(self) -> bool:
        """Whether a goal has not ended: one accepted here, or one that the server reports."""
        return self.ends.has_active() or not all(map(self._is_over, self.accepted))

    def wait_for_returns(self) -> None:
        """Wait for the results of accepted goals: a server that has sent them is free again."""
        self.watcher.spin_until_free(
            lambda: all(sent.is_answered() for sent in self.accepted), free_sec=RETURN_SEC
        )

    def _is_over(self, sent: SentGoal) -> bool:
        # the client that sent it may be closed: then only the status topic tells
        return sent.is_over() or any(s in TERMINAL for _, s in self.ends.statuses_of(sent.id))

    def answers(self) -> GoalAnswers:
        """How the server has answered so far, including its answers to earlier checks."""
        return answers_of(self.identity())

    def expect_alone(self) -> None:
        """The action has no second server at this time. Raises CheckFailed."""
        count = self.watcher.node.count_services(f'{self.name}/_action/send_goal')
        names = ', '.join(sorted(actions.take_graph(self.watcher.node).servers.get(self.name, {})))
        expect(
            count <= 1,  # count servers, not names: two nodes may have the same name
            expected=f'one server of the action {self.name}',
            seen=f'{count} ({student_text(names)})',
            hint='stop the other node: nobody knows which one moves the arm'
            if ',' in names
            else 'make the ActionServer once, in __init__, and start the node once',
            cause=f'{self.name} has more than one server',
        )

    def identity(self) -> Identity:
        """The GIDs of the feedback publishers: no other server has them, whatever its name."""
        infos = self.watcher.node.get_publishers_info_by_topic(f'{self.name}/_action/feedback')
        return tuple(sorted(tuple(info.endpoint_gid) for info in infos))

    def send(self, goal: Any, *, ends: ActionEnds | None = None) -> SentGoal:
        """Send a goal, wait for the response, and request the result if the goal is accepted.

        Raises CheckFailed with the reason if no response comes.
        """
        sent = (ends or self.ends).send(goal)
        self.answer_to(sent.answer, what='the goal')
        if sent.is_accepted:
            sent.ask_for_result()
            self.accepted.append(sent)
        note_answer(self.identity(), sent_ns=sent.sent_ns, is_accepted=sent.is_accepted)
        return sent

    def answer_to(self, asked: Future, *, what: str) -> Any:
        """Wait for the response `asked`. Raises CheckFailed with the reason if none comes."""
        if not wait_for_all(self.watcher, [asked], gives_up=self.raised.hint):
            fail(
                expected=f'an answer to {what}',
                seen='none',
                hint=self.raised.hint_or_thread() or self._why_unanswered(),
                cause=f'{self.name} does not answer',
            )
        return asked.result()

    def fail_without_end(self, sent: SentGoal, *, it: str, none: str, hint: str = '') -> NoReturn:
        """Raise CheckFailed with the reason: a goal has not ended.

        The message shows `it` if the goal has a status, otherwise `none`. `hint` says what to try,
        if the caller knows; otherwise `why_no_end` does.
        """
        fail(
            expected='the goal to end',
            seen=it if sent.status else none,
            hint=hint or self.why_no_end(sent),
            cause='a goal does not end',
        )

    def why_no_end(self, sent: SentGoal) -> str:
        """What to try if an accepted goal does not end, or has no result."""
        if hint := self.raised.hint() or self.log.raised(since_ns=sent.sent_ns):
            if sent.status in TERMINAL:
                return 'end the execute callback with `return MoveArm.Result(…)`, in each branch'
            return hint
        if sent.status == 'accepted':
            return (
                'the goal was accepted, and is not executed: a handle_accepted_callback calls '
                'goal_handle.execute()'
            )
        if hint := self.raised.hint_or_thread():
            return hint
        if self._is_blocked():
            return BLOCKED
        return 'end the loop of the execute callback when the arm is there'

    def _wait_for_rest(self) -> None:
        self.watcher.spin_until_free(lambda: not self.has_active(), free_sec=REST_SEC)

    def _find(self) -> str:
        found: dict[str, tuple[str, ...]] = {}

        def is_there() -> bool:
            found.clear()
            found.update(actions.take_graph(self.watcher.node).servers.get(self.name, {}))
            return bool(found)

        if none := wait_for_server(self.watcher, self.name, is_there):
            fail(
                expected=f'a server of the action {self.name}',
                seen=none.seen,
                hint=actions.take_graph(self.watcher.node).why_none(
                    self.name, maker='ActionServer'
                ),
                doubt=none.doubt,
            )
        expect_type(self.name, self.type, found, maker='ActionServer')
        self.expect_alone()
        return next(iter(found))

    def _is_blocked(self) -> bool:
        """Whether a goal is active and the node's parameter services exist but do not answer."""
        name = self.node_name
        can_answer = name in nodes_with_services(self.watcher.node)
        return self.has_active() and can_answer and not answers_parameters(self.watcher, name)

    def _why_unanswered(self) -> str:
        if self._is_blocked():
            return BLOCKED
        if answers_parameters(self.watcher, self.node_name):
            return (
                f'{student_text(self.node_name)} runs, and a callback of the action has not '
                'returned: see what it waits for'
            )
        return (
            f'{student_text(self.node_name)} answers nothing at all, so see that it spins, and '
            'that no callback waits'
        )
