"""A node that sends goals: meet it, expect one goal for a message, and say why none comes."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from my_robot_basics.checks.actions.scripted_action import ReceivedGoal
from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.services.services import answers_parameters
from my_robot_basics.exchange.values import type_name
from my_robot_basics.feedback.errors import expect, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import actions
from my_robot_basics.graph.watcher import Watcher

WAITS = (
    'it waits inside a callback, and no answer is delivered meanwhile: use send_goal_async and '
    'get_result_async, each with add_done_callback, or `await` with the callback and the client '
    'in one ReentrantCallbackGroup'
)
IS_TRUE = 'look at message.data: only True asks to cancel'
EACH_TRUE = (
    'each True cancels the goal that moves the arm then, also if the message before it was True: '
    'wait for no False in between'
)
CANCEL_SEC = 0.5
"""How long a request to cancel may take that tells why there was none before, in s of free
time."""
MEET_SEC, MET_SEC = 2.0, 0.2
"""How long to wait for a client, and then for it to discover the server, in s of wall time."""


def meet_client(watcher: Watcher, name: str) -> None:
    """Wait until a client of that action is known: it discovers the server at about that time."""
    end = f'{name}/_action/send_goal'
    watcher.spin_until(lambda: watcher.node.count_clients(end) > 0, timeout_sec=MEET_SEC)
    watcher.spin_for(MET_SEC)


def expect_one(goals: Collection[ReceivedGoal], *, asked_on: str) -> None:
    """No message on the topic `asked_on` leads to several goals. Raises CheckFailed."""
    expect(
        len(goals) <= 1,
        expected=f'one goal for each message on {asked_on}',
        seen=f'{len(goals)} for one message',
        hint='call send_goal_async(goal) once for each message, and subscribe to '
        f'{asked_on} once, in one node',
        cause='a message leads to several goals',
    )


@dataclass
class AskedGoals:
    """Which goals the messages on a topic ask for."""

    asked_on: str
    cancelled_on: str
    is_obstacle: bool = False
    """Whether the last message on `cancelled_on` said that there is an obstacle."""
    messages: list[Any] = field(default_factory=list)
    """The messages that were published, in order."""
    is_for: Callable[[Any, Any], bool] = lambda message, request: True
    """Whether a goal's request is what a message asks for."""
    _since: int | None = None
    """How many goals had come when the client had certainly processed the first message. Those
    before may be for messages that it received before the check."""

    def expect_no_others(self, goals: Sequence[ReceivedGoal]) -> None:
        """No goal comes that no message asks for. Raises CheckFailed."""
        if self._since is None:
            self._since = len(goals) or None
        for goal in goals[self._since or 0 :]:
            expect(
                any(self.is_for(message, goal.request) for message in self.messages),
                expected=f'no goal but those for the messages on {self.asked_on}',
                seen=shorten(goal.request),
                hint=f'send a goal in the callback of {self.asked_on}, for its message, and '
                'nowhere else',
                cause='a goal is sent that no message asks for',
            )


def why_no_goal(
    watcher: Watcher,
    name: str,
    type_: type,
    *,
    node_names: Collection[str],
    raised: CallbackErrors,
    asked: AskedGoals,
    was_away: bool,
) -> str:
    """Advice if no goal comes for a message.

    `was_away`: whether there was no server when an earlier message came.
    """
    if hint := raised.hint_or_thread():
        return hint
    asked_on, cancelled_on = asked.asked_on, asked.cancelled_on
    ends = actions.take_graph(watcher.node)
    clients = ends.clients.get(name, {})
    if not clients:
        return ends.why_none(name, maker='ActionClient')
    types = {each for found in clients.values() for each in found}
    if type_name(type_) not in types:
        asks_for = student_text(' and '.join(sorted(types)))
        return f'it sends goals of {asks_for}, so compare the type in ActionClient(…)'
    hint = (
        f'call send_goal_async(goal) for each message on {asked_on}, when it arrives, also while '
        'another goal moves the arm'
    )
    if asked.is_obstacle:
        hint = (
            f'call send_goal_async(goal) for each message on {asked_on}, also after True on '
            f'{cancelled_on}: an obstacle cancels the goal that moves the arm then, and no later '
            'one'
        )
    if was_away:
        hint = (
            'a goal that is sent while there is no server never gets an answer, so let no later '
            'pose wait for it: look at server_is_ready() before you send'
        )
    return why_silent(watcher, hint, node_names=node_names, raised=raised)


def why_silent(
    watcher: Watcher, hint: str, *, node_names: Collection[str], raised: CallbackErrors
) -> str:
    """Advice if a node does nothing after an answer; `hint` is the one if it does not block."""
    if why := raised.hint_or_thread():
        return why
    is_free = all(answers_parameters(watcher, name) for name in set(node_names))
    return hint if is_free else WAITS


def how_to_cancel(
    watcher: Watcher,
    goal: ReceivedGoal,
    goals: Collection[ReceivedGoal],
    *,
    say: Callable[[bool], None],
) -> str:
    """Advice if a goal is not cancelled; `goals` are all that came.

    `say` publishes whether there is an obstacle, to see what the client cancels the goal for.
    """
    for is_there, hint in (False, IS_TRUE), (True, EACH_TRUE):
        say(is_there)
        if watcher.spin_until_free(lambda: bool(goal.cancels), free_sec=CANCEL_SEC):
            return hint
    if any(not each.is_accepted and each.received_ns > goal.received_ns for each in goals):
        return (
            'a rejected goal came in between, so keep the goal handle that was accepted, and call '
            'its cancel_goal_async(), also if you have cancelled an earlier goal'
        )
    return 'call cancel_goal_async() of the goal handle that was accepted'
