"""A run of `arm_player` with the check's own servers, checked target by target."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NoReturn, Self

from my_robot_basics.checks.actions.scripted_action import ReceivedGoal
from my_robot_basics.checks.packages import drawing_hints
from my_robot_basics.checks.packages.packages import RunningExecutable, package
from my_robot_basics.checks.packages.player_meeting import LATER_SEC, NAME, PlayerMeeting
from my_robot_basics.checks.packages.player_report import PlayerReport
from my_robot_basics.checks.packages.player_servers import (
    MOVE_ARM,
    SOLVE_IK,
    PlayerServers,
    Target,
    is_near,
)
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.graph.watcher import Watcher

SPEED, SPEED_NEAR = 0.5, 1e-6
"""The speed that each goal has to request, and how exactly, in rad/s."""
REPLY_SEC, QUIET_SEC, MORE_SEC = 4.0, 0.2, 0.8
"""How long to wait for a request or a goal, and for what must not come, such as a second report:
in s of free time. A goal takes at most MORE_SEC of wall time more: a node may give up in 5 s."""


class Drawing:
    """The player that was started with these targets, the check's servers, and the report."""

    def __init__(
        self, watcher: Watcher, process: RunningExecutable, targets: Sequence[Target]
    ) -> None:
        self._watcher, self._process, self._targets = watcher, process, targets
        self._servers = PlayerServers(watcher, targets)
        self._meeting = PlayerMeeting(watcher, process)
        self._report = PlayerReport(watcher)
        self._comes = watcher.spin_until_free
        self._goals = 0
        """How many goals the player should have sent so far."""

    @classmethod
    @contextmanager
    def opened(cls, watcher: Watcher, targets: Sequence[Target]) -> Iterator[Self]:
        """Start the player, without servers yet. Raises CheckFailed if it does not start."""
        numbers = [number for _, x, y in targets for number in (x, y)]
        with package(NAME).run(NAME, parameters={'targets': numbers}) as process:
            drawing = cls(watcher, process, targets)
            try:
                yield drawing
            finally:
                drawing._servers.stop()

    def expect_waits_for_both(self, *, arm_first: bool) -> None:
        """Expect no request to `/solve_ik` while there is no `/move_arm`, then start both servers.

        `arm_first`: start `/move_arm` first instead. Then a request that is sent too early is
        lost, and `expect_visit` waits for it in vain. Raises CheckFailed.
        """
        self._meeting.wait_for_clients()
        if arm_first:
            self._servers.start_arm()
            self._watcher.spin_for(LATER_SEC)
        else:
            self._meeting.expect_not_asked_yet(self._servers.solver)
        self._servers.start()

    def expect_visit(self, number: int, *, goal_sec: float) -> None:
        """Expect a request for a target and its goal; end the goal as the target's word says.

        The goal takes `goal_sec` of free time, and nothing may come before. Raises CheckFailed.
        """
        word = self._targets[number][0]
        self._expect_asked(number)
        if word == 'unreachable':
            return
        goal = self._expect_goal(number)
        if word == 'rejected':
            return
        self._comes(self._is_too_soon, free_sec=goal_sec, wall_sec=goal_sec + MORE_SEC)
        self._expect_one_at_a_time()
        self._report.expect_none_yet()
        if word == 'canceled':
            self._servers.cancel(goal)
        else:
            goal.finish('succeeded' if word == 'succeeded' else 'aborted')

    def expect_end(self, *, stays_sec: float = 0.0) -> None:
        """Expect one report, kept for late subscribers, with each target's word; no more goals.

        The node still runs `stays_sec` of free time later. Raises CheckFailed.
        """
        words = [word for word, _, _ in self._targets]
        if not self._comes(self._report.is_there, free_sec=REPLY_SEC):
            self._meeting.fail_silent(
                expected=f'the report on {self._report.topic_name}',
                hint=self._report.why_none() or drawing_hints.why_no_report(self._watcher),
                cause='there is no report',
            )
        self._report.expect_words(words)
        self._expect_one_at_a_time()
        self._report.expect_kept(self._process, stays_sec=stays_sec)
        self._comes(self._report.has_come_twice, free_sec=QUIET_SEC)
        self._report.expect_once()
        self._meeting.expect_alone(own=1)

    def expect_clean_end(self, *, after_report: bool = False) -> None:
        """Expect it to end cleanly on SIGINT, while it waits for the answer to its first request.

        `after_report`: send SIGINT later than the report, if one comes. Raises CheckFailed.
        """
        self._process.expect_node(f'/{NAME}')
        if not after_report:
            self._servers.solver.hold()
        self._meeting.wait_for_clients()
        self._servers.start()
        self._expect_asked(0)  # if SIGINT comes earlier, rclpy itself prints a traceback
        if not after_report or self._report.comes_to_stay(free_sec=REPLY_SEC):
            self._process.expect_clean_end()

    def _expect_asked(self, number: int) -> None:
        servers = self._servers
        self._comes(
            lambda: servers.was_asked(number) or bool(servers.stray_requests()), free_sec=REPLY_SEC
        )
        _, x, y = self._targets[number]
        wanted = f'a request to {SOLVE_IK} for ({x:g}, {y:g})'
        if strays := servers.stray_requests():
            fail(
                expected=wanted,
                seen=f'one for ({strays[0].target.x:g}, {strays[0].target.y:g})',
                hint='the parameter targets is x1, y1, x2, y2, … in m: copy both to the request',
                cause=f'{SOLVE_IK} is asked for something else',
            )
        if not servers.was_asked(number):
            has_told = self._report.is_there()
            if servers.times_before(number) and (has_told or len(servers.goals) > self._goals):
                self._fail_not_again(wanted)
            before = self._targets[number - 1][0] if number else ''
            is_left_out = has_told and number + 1 == len(self._targets)
            how = {'was_skipped': servers.was_skipped(number), 'is_left_out': is_left_out}
            hint, cause = drawing_hints.why_not_asked(self._watcher, before, **how)
            self._meeting.fail_silent(expected=wanted, hint=hint, cause=cause)

    def _expect_goal(self, number: int) -> ReceivedGoal:
        goals, place = self._servers.goals, self._goals
        _, x, y = self._targets[number]
        if not self._comes(lambda: len(goals) > place, free_sec=REPLY_SEC):
            self._meeting.fail_silent(
                expected=f'a goal for {MOVE_ARM} for ({x:g}, {y:g})',
                hint=drawing_hints.why_no_goal(self._watcher),
                cause=f'{MOVE_ARM} is sent no goal',
            )
        goal = goals[place]
        if not is_near(goal.request.position, self._servers.pose(number)):
            self._fail_other_goal(number, goal)
        expect(
            abs(goal.request.speed - SPEED) < SPEED_NEAR,
            expected=f'a goal with the speed {SPEED:g} rad/s',
            seen=f'{goal.request.speed:g}',
            hint='give each goal the speed that the task names',
            cause='a goal has another speed',
        )
        self._goals += 1
        return goal

    def _is_too_soon(self) -> bool:
        return len(self._servers.goals) > self._goals or self._report.has_come()

    def _expect_one_at_a_time(self) -> None:
        expect(
            len(self._servers.goals) == self._goals,
            expected=f'one goal for {MOVE_ARM} at a time, and one for each target',
            seen=f'{len(self._servers.goals)} goals in place of {self._goals}',
            hint='send the next goal when the result of the one before is there',
            cause='goals are sent at once, or too many of them',
        )

    def _fail_other_goal(self, number: int, goal: ReceivedGoal) -> NoReturn:
        seen = goal.request.position[:4]
        fail(
            expected=f'a goal for target {number + 1}, {_rounded(self._servers.pose(number))} rad',
            seen=shorten(_rounded(seen)),
            hint=drawing_hints.why_other_goal(self._servers, number, seen),
            cause='a goal has another position, or another place in the order',
        )

    def _fail_not_again(self, wanted: str) -> NoReturn:
        fail(
            expected=f'{wanted} once more: it is listed twice',
            seen='the report' if self._report.is_there() else 'a goal',
            hint='ask for each target of the list, and visit it, also one that you have visited '
            'before',
            cause='a target that is listed twice is asked for once',
        )


def _rounded(position: Sequence[float]) -> list[float]:
    return [round(angle, 3) for angle in position]
