"""Whether a node logs all earlier targets' angles with each new answer, as a growing list does."""

from collections.abc import Sequence

from my_robot_basics.checks.nodes.node_log import NodeLog
from my_robot_basics.checks.values import angles
from my_robot_basics.feedback.errors import fail

FEWEST = 3
"""How many earlier targets must all be there: one or two may be answers that come twice."""


class RepeatedAnswers:
    """The angles of the targets so far."""

    def __init__(self) -> None:
        """Start without any target."""
        self._earlier: list[list[float]] = []

    def expect_none(self, wanted: Sequence[float], log: NodeLog) -> None:
        """Expect other targets' angles to be missing; note these. Raises CheckFailed."""
        numbers = log.numbers()
        others = [each for each in self._earlier if each != [*wanted]]
        if len(others) >= FEWEST and not any(angles.missing(each, numbers) for each in others):
            fail(
                expected=f'the angles of one target in the INFO log of {log.node_name}',
                seen=log.shown('INFO'),
                hint='begin with an empty list or text in each call of the callback: an attribute,'
                ' or a default such as lines=[], keeps what earlier calls have added',
                cause='the angles of all earlier targets are logged again with each target',
            )
        self._earlier = [*others, [*wanted]]
