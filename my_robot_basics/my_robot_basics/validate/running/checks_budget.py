"""How long *Validate* waits for the checks of an exercise: its advice has to come soon."""

from dataclasses import dataclass

from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.kernels.kernel import LocalKernel
from my_robot_basics.validate.kernels.limits import VALIDATE_CHECKS_MOST_SEC, VALIDATE_CHECKS_SEC
from my_robot_basics.validate.kernels.messages import OnInput
from my_robot_basics.validate.kernels.outputs import CellRun

TOO_SLOW = (
    f'not checked here: the checks of this exercise have taken {VALIDATE_CHECKS_SEC:g} s, and '
    'those of a right answer take a few; look for what is slow in yours. Grading waits longer'
)
TOO_BUSY = (
    f'not checked here: the checks of this exercise have taken {VALIDATE_CHECKS_MOST_SEC:g} s, '
    'on a machine that is busy; validate again when it is not, and if that is no better, look for '
    'what is slow in yours. Grading waits longer'
)


@dataclass
class ChecksBudget:
    """The remaining time for all checks of an exercise: with a free processor, and in all."""

    free_sec: float = VALIDATE_CHECKS_SEC
    wall_sec: float = VALIDATE_CHECKS_MOST_SEC
    given_up: CellRun | None = None
    """The check that was given up, if any: no other one starts after it."""

    async def run(self, kernel: LocalKernel, source: str, *, on_input: OnInput) -> CellRun:
        """Run a grade cell within the remaining time; `given_up` of the result says why not."""
        if self.given_up is not None:
            return self.given_up
        watch = Stopwatch()
        run = await kernel.run(
            source, timeout_sec=self.wall_sec, free_sec=self.free_sec, on_input=on_input
        )
        self.free_sec -= watch.free_sec()
        self.wall_sec -= watch.wall_sec()
        if run.cut_after_sec:
            run.given_up = TOO_BUSY if self.wall_sec <= 0.0 else TOO_SLOW
            self.given_up = run
        return run
