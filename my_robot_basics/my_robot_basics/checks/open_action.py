"""The server of an action, met by a check: send goals, and say why no answer comes."""

from typing import Any, NoReturn

from rclpy.task import Future

from my_robot_basics.checks.action_ends import TERMINAL, ActionEnds, SentGoal
from my_robot_basics.checks.callbacks import CallbackErrors
from my_robot_basics.checks.server_log import ServerLog
from my_robot_basics.checks.services import SERVER_SEC, answers_parameters, wait_for_all
from my_robot_basics.feedback.errors import expect, fail
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import actions, graphs
from my_robot_basics.graph.watcher import Watcher

REST_SEC = 2.5
"""How long to wait for the end of goals of earlier, and once more when they are cancelled."""


class OpenAction:
    """The server of an action, met by a watcher, while a check lasts."""

    def __init__(self, watcher: Watcher, name: str, type_: type) -> None:
        """Nobody is met yet."""
        self.watcher, self.name, self.type = watcher, name, type_
        self.ends = ActionEnds(watcher, name, type_)
        self.node_name = ''
        """The full name of the server's node."""
        self.accepted: SentGoal | None = None
        """The goal that it has accepted last."""

    def meet(self) -> None:
        """Wait for the one server, and for the end of goals of earlier. Raises CheckFailed."""
        self.node_name = self._find()
        self.raised = CallbackErrors([self.node_name])
        self.log = ServerLog(self.watcher, self.node_name)
        self.watcher.spin_until(self.ends.is_connected, timeout_sec=SERVER_SEC)
        self.watcher.spin_until(lambda: bool(self.ends.statuses.received), timeout_sec=0.1)
        if self.ends.has_active():
            self._wait_for_rest()
        if self.ends.has_active():
            self.ends.cancel_all()
            self._wait_for_rest()

    def send(self, goal: Any, *, ends: ActionEnds | None = None) -> SentGoal:
        """Send a goal and wait for the answer, and ask for the result where it is accepted.

        Raises CheckFailed where no answer comes, with the reason.
        """
        sent = (ends or self.ends).send(goal)
        self.answer_to(sent.answer, what='the goal')
        if sent.is_accepted:
            sent.ask_for_result()
            self.accepted = sent
        return sent

    def answer_to(self, asked: Future, *, what: str) -> Any:
        """The answer to what was asked. Raises CheckFailed where none comes, with the reason."""
        if not wait_for_all(self.watcher, [asked], gives_up=lambda: bool(self.raised.hint())):
            fail(
                expected=f'an answer to {what}',
                seen='none',
                hint=self.raised.hint() or self._why_unanswered(),
                cause=f'{self.name} does not answer',
            )
        return asked.result()

    def fail_without_end(self, sent: SentGoal, when: str) -> NoReturn:
        """A goal has not ended. Raises CheckFailed with the reason."""
        fail(
            expected='the goal to end',
            seen=f'none {when}' if not sent.status else f'it {sent.status} {when}',
            hint=self.why_no_end(sent),
            cause='a goal does not end',
        )

    def why_no_end(self, sent: SentGoal) -> str:
        """What to try where an accepted goal does not end, or has no result."""
        if hint := self.raised.hint() or self.log.raised(since_ns=sent.sent_ns):
            if sent.status in TERMINAL:
                return 'end the execute callback with `return MoveArm.Result(…)`, in each branch'
            return hint
        if sent.status == 'accepted':
            return (
                'the goal was accepted, and is not executed: a handle_accepted_callback calls '
                'goal_handle.execute()'
            )
        return 'end the loop of the execute callback when the arm is there'

    def _wait_for_rest(self) -> None:
        self.watcher.spin_until_free(lambda: not self.ends.has_active(), free_sec=REST_SEC)

    def _find(self) -> str:
        found: dict[str, tuple[str, ...]] = {}

        def is_there() -> bool:
            found.clear()
            found.update(actions.take(self.watcher.node).servers.get(self.name, {}))
            return bool(found)

        is_settled = graphs.is_settled(self.watcher)
        timeout_sec = graphs.SETTLED_SEC if is_settled else SERVER_SEC
        if not self.watcher.spin_until(is_there, timeout_sec=timeout_sec):
            fail(
                expected=f'a server of the action {self.name}',
                seen=graphs.none_in(timeout_sec),
                hint=actions.take(self.watcher.node).why_none(self.name, maker='ActionServer'),
            )
        wanted = type_name(self.type)
        types = sorted({each for types in found.values() for each in types})
        expect(
            types == [wanted],
            expected=f'a server of {self.name} for {wanted}',
            seen=f'one for {theirs(" and ".join(types))}',
            hint='compare the type in ActionServer(…)',
            cause=f'{self.name} has another type',
        )
        # two nodes may have one name
        self.watcher.spin_for(graphs.NEWCOMER_SEC)
        count = self.watcher.node.count_services(f'{self.name}/_action/send_goal')
        expect(
            count == 1,
            expected=f'one server of the action {self.name}',
            seen=f'{count} ({theirs(", ".join(sorted(found)))})',
            hint='stop the other node: nobody knows which one moves the arm',
            cause=f'{self.name} has more than one server',
        )
        return next(iter(found))

    def _why_unanswered(self) -> str:
        if answers_parameters(self.watcher, self.node_name):
            return (
                f'{theirs(self.node_name)} runs, and a callback of the action has not returned: '
                'see what it waits for'
            )
        return (
            f'{theirs(self.node_name)} answers nothing at all, so see that it spins, and that no '
            'callback waits'
        )


def type_name(type_: type) -> str:
    """The name of an action's class: 'arm_interfaces/action/MoveArm'."""
    return f'{type_.__module__.partition(".")[0]}/action/{type_.__name__}'
