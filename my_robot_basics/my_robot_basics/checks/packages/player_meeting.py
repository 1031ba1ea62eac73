"""The start of `arm_player`: the check waits for its clients, then starts the servers."""

from dataclasses import dataclass
from typing import NoReturn

from my_robot_basics.checks.clock.doubts import doubt_after
from my_robot_basics.checks.packages import drawing_hints
from my_robot_basics.checks.packages.packages import RunningExecutable
from my_robot_basics.checks.packages.player_servers import MOVE_ARM, SOLVE_IK
from my_robot_basics.checks.services.holding_server import HoldingServer
from my_robot_basics.checks.services.sole_server import expect_no_other
from my_robot_basics.feedback.errors import CheckFailed, expect, fail
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

NAME = 'arm_player'  # the name of the package, of the executable and of the node
MEET_SEC = 8.0
"""How long a new process may take until its client of `/solve_ik` exists, in s of free time."""
SECOND_SEC = 1.0
"""How long to wait then for its client of `/move_arm`, in s of free time. It need not exist: some
nodes create it only when they need it."""
LATER_SEC = 1.5
"""How much later the second server appears than the first, to detect nodes that wait only 1 s. A
node waits by the wall clock, so this is wall time: free time could exceed a wait of 5 s."""


@dataclass(frozen=True)
class PlayerMeeting:
    """The `arm_player` process that the check has started, and the servers that it finds."""

    watcher: Watcher
    process: RunningExecutable

    def wait_for_clients(self) -> None:
        """Wait for the node's clients before creating servers, which then know them already.

        Raises CheckFailed if there is no client of `/solve_ik`, or another node serves.
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
        """Start `/solve_ik`; the node sends no request while `/move_arm` is absent.

        Raises CheckFailed.
        """
        solver.start()
        is_asked = self.watcher.spin_until(lambda: bool(solver.requests), timeout_sec=LATER_SEC)
        expect(
            not is_asked,
            expected=f'no request to {SOLVE_IK} while there is no {MOVE_ARM} yet',
            seen='one',
            hint='wait for both servers first: wait_for_service of the client, and '
            'wait_for_server of the ActionClient',
            cause=f'{NAME} does not wait for {MOVE_ARM}',
        )

    def expect_alone(self, *, own: int) -> None:
        """There are only the check's `own` servers of each name. Raises CheckFailed."""
        # the notebook may have started it as a process, which stop() ends, too
        for name in SOLVE_IK, f'{MOVE_ARM}/_action/send_goal':
            expect_no_other(self.watcher, name, own=own, stop='stop()')

    def fail_silent(
        self, *, expected: str, hint: str, cause: str, doubt: type[CheckFailed] = CheckFailed
    ) -> NoReturn:
        """Raise CheckFailed: nothing came. If the process has ended, that is the reason given."""
        self.process.expect_running()
        fail(expected=expected, seen='none', hint=hint, cause=cause, doubt=doubt)
