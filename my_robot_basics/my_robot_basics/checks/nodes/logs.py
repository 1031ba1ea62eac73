"""What a node logs, as all nodes can read it: the topic /rosout."""

from collections.abc import Callable, Iterable, Sequence
from typing import Self

from my_robot_basics.checks.nodes.node_log import NodeLog
from my_robot_basics.checks.nodes.repeated_answers import RepeatedAnswers
from my_robot_basics.checks.nodes.unlogged import why_unlogged
from my_robot_basics.checks.values import angles, answers, pairing
from my_robot_basics.feedback.errors import fail

EXTRA_SEC = 0.3
"""How long after a warning angles may still come, in seconds."""
WARNED_SEC = 0.1
"""How long after the angles a warning may come; the next target's check finds a later one."""
ANSWER_SEC, ONCE_MORE_SEC = 3.0, 1.5
"""How long to wait for the answer to a target, and to a target that is sent a second time, in
seconds of free time."""


def rosout(node_name: str) -> 'Log':
    """Return the log of a node and of its logger's children, for use in a `with` statement.

    ```python
    with rosout('ik_solver_node') as log:
        log.ask('/target_point', Point(x=1.2, y=0.3))
        log.expect_solutions(inverse_kinematics(1.2, 0.3), target=(1.2, 0.3))
    ```
    """
    return Log(node_name)


class Log(NodeLog):
    """What a check may expect of one node's log, in a `with` statement."""

    def __init__(self, node_name: str) -> None:
        """Use `with rosout(node_name) as log`; the `with` statement subscribes to /rosout."""
        super().__init__(node_name)
        self._forms = answers.Forms()
        self._repeated = RepeatedAnswers()
        self._has_warned = False
        self._answer: list[float] = []
        """The angles of the last target in reach."""

    def expect_solutions(
        self,
        solutions: pairing.Solutions,
        *,
        target: Sequence[float] = (),
        may_lag: bool = False,
    ) -> bool:
        """Expect both angles of each solution in INFO records; in pairs, each θ1 with its own θ2.

        Those of all earlier targets must not come again. All else is as in `expect_angles`.
        """
        angles_deg = [angle for pair in solutions for angle in pair]
        had_warning = self.expect_angles(angles_deg, target=target, may_lag=may_lag)
        if pairing.are_mixed_up(list(solutions), self.texts('INFO')):
            fail(
                expected=f'θ1 and θ2 of one solution together in the log of {self.node_name}',
                seen=self.shown('INFO'),
                hint='θ1 is paired with the θ2 of the other branch: both signs of θ2 are right, so'
                ' check the sign of θ2 in the formula for θ1',
            )
        self._repeated.expect_none(angles_deg, self)
        return had_warning

    def expect_angles(
        self,
        angles_deg: Iterable[float],
        *,
        target: Sequence[float] = (),
        within_deg: float = angles.WITHIN_DEG,
        free_sec: float = ANSWER_SEC,
        may_lag: bool = False,
    ) -> bool:
        """Expect all these angles in INFO records, on any number of lines, and no WARN record.

        Other numbers don't matter, up to a thousand, nor do whole turns. Raises CheckFailed after
        `free_sec` of free time; it names the `target` (m) that has these angles. With `may_lag`,
        a WARN before the answer is allowed: it may be about the target before, which a timer has
        handled once more. Returns whether there was one.
        """
        wanted = list(angles_deg)

        def is_answered(log: Self) -> bool:
            return not angles.missing(wanted, log.numbers(), within_deg)

        what = f'({", ".join(f"{metres:.3f}" for metres in target)})' if target else 'a target'
        is_there = self.wait_for_answer(is_answered, free_sec=free_sec)
        self._expect_no_table()
        if not is_there:
            self.expect_node()
            listed = ', '.join(f'{angle:.2f}°' for angle in wanted)
            fail(
                expected=f'{listed} for {what} in the INFO log of {self.node_name}',
                seen=self.shown('INFO'),
                hint=why_unlogged(self, 'INFO')
                or self._why_late(is_answered)
                or self._why_other(wanted),
                cause='the INFO log lacks the angles of a target in reach',
            )
        before = self.count('WARN') if may_lag else 0
        # a warning may come just after the answer
        if self.wait_for(lambda log: log.count('WARN') > before, timeout_sec=WARNED_SEC):
            fail(
                expected=f'no warning from {self.node_name} for {what}, which is in reach',
                seen=self.shown('WARN'),
                hint=angles.WARN_ONLY,
                cause='there is a warning for a target in reach',
            )
        self._raised.expect_none()
        self._forms.learn(wanted, self.texts('INFO'))
        self._answer = wanted
        return before > 0

    def expect_warning(
        self, *, no_angles: Iterable[float] = (), free_sec: float = ANSWER_SEC
    ) -> None:
        """Expect at least one WARN record, and no INFO record with angles.

        A record has angles if it looks like those with angles of a target in reach, with other
        numbers; after the warning, also with the same angles. Unless records of that form
        came beside the angles of a target in reach, zeros count, too, as do one of `no_angles`
        beside the θ2 of a stretched or folded arm, and both branches of a point in that direction.
        Raises CheckFailed after `free_sec` of free time.
        """
        bearings = list(no_angles)
        if not self.wait_for_answer(lambda log: log.has('WARN'), free_sec=free_sec):
            self.expect_node()
            fail(
                expected=f'a warning in the log of {self.node_name}',
                seen=self.shown('WARN'),
                hint=why_unlogged(self, 'WARN') or self._why_unwarned(),
                cause='there is no warning for a target out of reach',
            )
        levels = [record.level for record in self.records]
        count = levels[: levels.index('WARN')].count('INFO')
        self._has_warned = True

        def has_angles(log: Self) -> bool:
            texts = log.texts('INFO')
            unlike = [text for text in texts if not self._forms.is_other(text)]
            return answers.stand_for_angles(bearings, unlike) or any(
                (number >= count and answers.holds_any(self._answer, text))
                or (self._forms.is_answer(text) and not answers.holds_any(self._answer, text))
                for number, text in enumerate(texts)
            )

        # angles may come just after the warning, or a second one, which answers no later target
        if self.wait_for(has_angles, timeout_sec=EXTRA_SEC):
            fail(
                expected=f'no angles from {self.node_name} for a target out of reach',
                seen=self.shown('INFO'),
                hint='log angles only when inverse_kinematics returns some: return from the '
                'callback after the warning',
                cause='angles are logged for a target out of reach',
            )
        self._raised.expect_none()

    def _why_late(self, is_answered: Callable[[Self], bool]) -> str:
        """Send the target again: if its answer comes only now, each answer is one target late."""
        if self._asked is None or not self.has('INFO'):
            return ''
        since_ns = self._since_ns
        self.ask(*self._asked)
        is_late = self.wait_for_answer(is_answered, free_sec=ONCE_MORE_SEC)
        self._since_ns = since_ns
        return angles.ONE_LATE if is_late else ''

    def _why_other(self, wanted: Sequence[float]) -> str:
        if unreadable := answers.why_unreadable(wanted, self.texts('INFO')):
            return unreadable
        if self._answer and not angles.missing(self._answer, self.numbers()):
            return angles.EARLIER
        if self.asked_again and not self.records:
            return angles.AGAIN
        if self.has('INFO') or not self.has('WARN'):
            return angles.what_to_try(wanted, self.numbers())
        elsewhere = not angles.missing(wanted, self.numbers('WARN'), angles.ROUNDED_DEG)
        return angles.INFO_FOR_ANGLES if elsewhere else angles.WARN_ONLY + angles.IN_REACH

    def _why_unwarned(self) -> str:
        if self.records:
            return angles.WARN_EACH if self._has_warned else angles.NEEDS_WARN
        if self.asked_again:
            return angles.AGAIN
        return angles.CATCH

    def _expect_no_table(self) -> None:
        count = len(set(self.numbers()))
        if count > answers.MOST_NUMBERS:
            fail(
                expected=f'the angles of one target in the INFO log of {self.node_name}',
                seen=f'{count:,} different numbers',
                hint='log the solutions of each target, and not all possible angles',
                cause=f'over {answers.MOST_NUMBERS:,} different numbers for one target',
            )
