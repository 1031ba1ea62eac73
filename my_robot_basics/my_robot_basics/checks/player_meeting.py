"""A run of `arm_player` until it may ask: its clients are there, and then the servers."""

from dataclasses import dataclass
from typing import NoReturn

from my_robot_basics.checks import drawing_hints
from my_robot_basics.checks.doubts import doubt_after
from my_robot_basics.checks.holding_server import HoldingServer
from my_robot_basics.checks.packages import RunningExecutable
from my_robot_basics.checks.player_servers import MOVE_ARM, SOLVE_IK
from my_robot_basics.checks.sole_server import expect_no_other
from my_robot_basics.feedback.errors import CheckFailed, expect, fail
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

NAME = 'arm_player'  # of the package, of the executable and of the node
MEET_SEC = 8.0
"""How long the clients of a program that was just started may take, of free time. …"""
SECOND_SEC = 1.0
"""… A client that is made only when it is needed is not waited for longer."""
ALONE_SEC = 0.8
"""How long who does not wait for `/move_arm` may take to ask the solver: rclpy's wait_for_service
looks each 0.25 s."""
LATER_SEC = 1.5
"""So much later does `/solve_ik` come than `/move_arm`: some wait for a second at most."""


@dataclass(frozen=True)
class PlayerMeeting:
    """The player that was started, and whom it finds."""

    watcher: Watcher
    process: RunningExecutable

    def wait_for_clients(self) -> None:
        """Wait for its clients, before there is a server: none of them asks one it has not met.

        Raises CheckFailed if none comes, or somebody else serves.
        """
        count = self.watcher.node.count_clients
        self.expect_alone(own=0)
        watch = Stopwatch()
        if not self.watcher.spin_until_free(lambda: count(SOLVE_IK) > 0, free_sec=MEET_SEC):
            doubt = doubt_after(watch, MEET_SEC)
            self.fail_silent(
                expected=f'a client of {SOLVE_IK}',
                hint=drawing_hints.why_no_client(self.watcher),
                cause=f'{NAME} has no client of {SOLVE_IK}',
                doubt=doubt,
            )
        self.watcher.spin_until_free(
            lambda: count(f'{MOVE_ARM}/_action/send_goal') > 0, free_sec=SECOND_SEC
        )

    def expect_not_asked_yet(self, solver: HoldingServer) -> None:
        """It asks the solver for nothing, which serves from now on, while there is no arm."""
        solver.start()
        is_asked = self.watcher.spin_until_free(lambda: bool(solver.requests), free_sec=ALONE_SEC)
        expect(
            not is_asked,
            expected=f'no request to {SOLVE_IK} while there is no {MOVE_ARM} yet',
            seen='one',
            hint='wait for both servers first: wait_for_service of the client, and '
            'wait_for_server of the ActionClient',
            cause=f'{NAME} does not wait for {MOVE_ARM}',
        )

    def expect_alone(self, *, own: int) -> None:
        """The check's `own` servers are all that there are. Raises CheckFailed."""
        expect_no_other(self.watcher, SOLVE_IK, own=own)
        expect_no_other(self.watcher, f'{MOVE_ARM}/_action/send_goal', own=own)

    def fail_silent(
        self, *, expected: str, hint: str, cause: str, doubt: type[CheckFailed] = CheckFailed
    ) -> NoReturn:
        """Raise CheckFailed: nothing came. Whoever has ended says why."""
        self.process.expect_running()
        fail(expected=expected, seen='none', hint=hint, cause=cause, doubt=doubt)
