"""What a node logs, as everybody else on the robot can read it: the topic /rosout."""

import re
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Self

from rcl_interfaces.msg import Log as LogMessage
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

from my_robot_basics.checks import angles, answers
from my_robot_basics.checks.callbacks import Raised
from my_robot_basics.checks.topics import Topic
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.graph import graphs
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.raised import what_raised
from my_robot_basics.graph.watcher import Watcher

LEVELS = {10: 'DEBUG', 20: 'INFO', 30: 'WARN', 40: 'ERROR', 50: 'FATAL'}
DEPTH = 1000
NODE_SEC = 10.0
AFTERTHOUGHT_SEC = 0.3
"""How long angles may come behind a warning …"""
WARNED_SEC = 0.1
"""… And a warning behind the angles: a later one is found with the next target."""
ONCE_MORE_SEC = 2.0
"""How long to wait for the answer to a target that is sent a second time."""
ONE_LATE = 'each answer is one target late: use the point that the callback is given, at once'
EARLIER = 'these are the angles of an earlier target: use the point that the callback is given'
_NAN = re.compile(r'\bnan\b', re.IGNORECASE)
WARN_ONLY = 'warn only when inverse_kinematics(x, y) raises ValueError'
INFO_FOR_ANGLES = 'log angles with self.get_logger().info(…), and ' + WARN_ONLY


@dataclass(frozen=True)
class Record:
    """One log record."""

    level: str
    """'DEBUG', 'INFO', 'WARN', 'ERROR' or 'FATAL'."""
    text: str
    """As the node logged it, without time and logger's name."""


def rosout(node_name: str) -> 'Log':
    """The log of a node and of its logger's children, to be opened by a `with` statement.

    ```python
    with rosout('ik_solver_node') as log:
        log.ask('/target_point', Point(x=1.2, y=0.3))
        log.expect_solutions(inverse_kinematics(1.2, 0.3), target=(1.2, 0.3))
    ```
    """
    return Log(node_name)


class Log:
    """A context manager that listens to one node's log.

    Only records that were logged since `mark()` count (at first, since it began to listen):
    /rosout is latched, and would otherwise bring answers to older questions.
    """

    def __init__(self, node_name: str) -> None:
        """Use `with rosout(node_name) as log`; listening begins with the `with` statement."""
        self._logger = node_name.strip('/').replace('/', '.')
        self._node_name = f'/{node_name.strip("/")}'
        self._heard: list[tuple[int, Record]] = []
        self._watcher = Watcher()
        self._since_ns = 0
        self._publishers: dict[str, Publisher] = {}
        self._forms: set[str] = set()
        """Texts without their numbers that held angles, of targets in reach."""
        self._asked: tuple[str, Any] | None = None
        """The topic and the target that was sent last."""
        self._answer: list[float] = []
        """The angles of the last target in reach."""

    def __enter__(self) -> Self:
        """Subscribe and wait for the node. Raises CheckFailed when it does not come."""
        self._watcher.__enter__()
        try:
            self._meet()
        except BaseException:
            self._watcher.__exit__()
            raise
        self.mark()
        self._raised = Raised([self._node_name])
        return self

    def __exit__(self, *_: object) -> None:
        """Stop listening."""
        self._watcher.__exit__()

    def mark(self) -> None:
        """Let only records count that are logged from now on."""
        self._since_ns = time.time_ns()

    def ask(self, topic_name: str, message: Any) -> None:
        """Publish a target, of which the records since then are to tell.

        Raises CheckFailed where nobody subscribes to the topic.
        """
        if topic_name not in self._publishers:
            publisher = Topic(topic_name).meet(self._watcher, type(message))
            self._publishers[topic_name] = publisher
        self.mark()
        self._asked = topic_name, message
        self._publishers[topic_name].publish(message)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records that were received since the mark, oldest first."""
        return tuple(record for sent_ns, record in self._heard if sent_ns > self._since_ns)

    def numbers(self, level: str = 'INFO', *, since: int = 0) -> tuple[float, ...]:
        """All numbers in the records of a level since the mark, in order; or `since` its n-th."""
        texts = self._texts(level)[since:]
        return tuple(number for text in texts for number in answers.numbers_of(text))

    def wait_for(self, done: Callable[[Self], bool], *, timeout_sec: float = 5.0) -> bool:
        """Listen until `done(log)`, at most `timeout_sec`; whether it came to that."""
        return self._watcher.spin_until(lambda: done(self), timeout_sec=timeout_sec)

    def expect_solutions(
        self,
        solutions: answers.Solutions,
        *,
        target: Sequence[float] = (),
        may_lag: bool = False,
    ) -> bool:
        """INFO records hold both angles of each solution, each θ1 with its own θ2, where in pairs.

        The rest is as `expect_angles` says.
        """
        angles_deg = [angle for pair in solutions for angle in pair]
        had_warning = self.expect_angles(angles_deg, target=target, may_lag=may_lag)
        if answers.are_mixed_up(list(solutions), self._texts('INFO')):
            fail(
                expected=f'θ1 and θ2 of one solution together in the log of {self._node_name}',
                seen=self._shown('INFO'),
                hint='θ1 is paired with the θ2 of the other branch: both signs of θ2 are right, so'
                ' check the sign of θ2 in the formula for θ1',
            )
        return had_warning

    def expect_angles(
        self,
        angles_deg: Iterable[float],
        *,
        target: Sequence[float] = (),
        within_deg: float = angles.WITHIN_DEG,
        timeout_sec: float = 5.0,
        may_lag: bool = False,
    ) -> bool:
        """INFO records hold every one of these angles, on any number of lines; no WARN is there.

        Other numbers don't matter, up to a thousand, nor do whole turns. Raises CheckFailed after
        `timeout_sec`; it names the `target` (m) that has these angles. With `may_lag`, a WARN
        before the answer may be about the target before, which a timer has taken up once more;
        returns whether there was one.
        """
        wanted = list(angles_deg)

        def is_answered(log: Self) -> bool:
            return not angles.missing(wanted, log.numbers(), within_deg)

        what = f'({", ".join(f"{metres:.3f}" for metres in target)})' if target else 'a target'
        is_there = self.wait_for(is_answered, timeout_sec=timeout_sec)
        self._expect_no_table()
        if not is_there:
            listed = ', '.join(f'{angle:.2f}°' for angle in wanted)
            fail(
                expected=f'{listed} for {what} in the INFO log of {self._node_name}',
                seen=self._shown('INFO'),
                hint=self._why_late(is_answered) or self._why_unanswered(wanted),
                cause='the INFO log lacks the angles of a target in reach',
            )
        before = self._count('WARN') if may_lag else 0
        # a warning may come just behind the answer
        if self.wait_for(lambda log: log._count('WARN') > before, timeout_sec=WARNED_SEC):
            fail(
                expected=f'no warning from {self._node_name} for {what}, which is in reach',
                seen=self._shown('WARN'),
                hint=WARN_ONLY,
                cause='there is a warning for a target in reach',
            )
        self._raised.expect_none()
        self._forms |= answers.forms_with(wanted, self._texts('INFO'))
        self._answer = wanted
        return before > 0

    def expect_warning(self, *, no_angles: Iterable[float] = (), timeout_sec: float = 5.0) -> None:
        """At least one WARN record comes, and no INFO record with angles.

        That is one that looks like those which held the angles of a target in reach, and has
        other numbers; once the warning is there, these very angles, too; and one of `no_angles`
        beside the θ2 of a stretched or folded arm. Raises CheckFailed after `timeout_sec`.
        """
        bearings = list(no_angles)
        if not self.wait_for(lambda log: log._has('WARN'), timeout_sec=timeout_sec):
            fail(
                expected=f'a warning in the log of {self._node_name}',
                seen=self._shown('WARN'),
                hint=self._why_unwarned(),
                cause='there is no warning for a target out of reach',
            )
        levels = [record.level for record in self.records]
        count = levels[: levels.index('WARN')].count('INFO')

        def has_angles(log: Self) -> bool:
            texts = log._texts('INFO')
            return any(
                answers.has_stretched(bearings, text)
                or (number >= count and answers.holds_any(self._answer, text))
                or (
                    answers.form_of(text) in self._forms
                    and not answers.holds_any(self._answer, text)
                )
                for number, text in enumerate(texts)
            )

        # angles may come just behind the warning, and so may a second one, which is no answer to
        # the next target
        if self.wait_for(has_angles, timeout_sec=AFTERTHOUGHT_SEC):
            fail(
                expected=f'no angles from {self._node_name} for a target out of reach',
                seen=self._shown('INFO'),
                hint='log angles only when inverse_kinematics returns some: return from the '
                'callback after the warning',
                cause='angles are logged for a target out of reach',
            )
        self._raised.expect_none()

    def _meet(self) -> None:
        node = self._watcher.node
        latched = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(LogMessage, '/rosout', with_info(self._hear), latched)

        def is_there() -> bool:
            infos = node.get_publishers_info_by_topic('/rosout')
            return self._node_name in map(graphs.full_name, infos)

        is_settled = graphs.is_settled(self._watcher, self._node_name)
        timeout_sec = graphs.SETTLED_SEC if is_settled else NODE_SEC
        if not self._watcher.spin_until(is_there, timeout_sec=timeout_sec):
            others = graphs.take(self._watcher).nodes()
            fail(
                expected=f'a node {self._node_name}',
                seen=', '.join(others) or 'no node',
                hint=self._why_absent(others),
            )

    def _hear(self, message: LogMessage, info: dict) -> None:
        if message.name == self._logger or message.name.startswith(f'{self._logger}.'):
            level = LEVELS.get(message.level, str(message.level))
            self._heard.append((info['source_timestamp'], Record(level, message.msg)))

    def _why_absent(self, others: Sequence[str]) -> str:
        if not others:
            return 'the node is not running, so run the cell that starts it and read its output'
        name = self._node_name.strip('/')
        if any(other.endswith(self._node_name) for other in others):
            return f'the name {name} is right, so leave the namespace out of super().__init__(…)'
        return f"if that is yours, write super().__init__('{name}'), letter for letter"

    def _why_late(self, is_answered: Callable[[Self], bool]) -> str:
        """Send the target once more; who answers it only now answers the one before."""
        if self._asked is None or not self._has('INFO'):
            return ''
        since_ns = self._since_ns
        self.ask(*self._asked)
        is_late = self.wait_for(is_answered, timeout_sec=ONCE_MORE_SEC)
        self._since_ns = since_ns
        return ONE_LATE if is_late else ''

    def _why_unanswered(self, wanted: Sequence[float]) -> str:
        raised = '' if self._has('INFO') else what_raised([self._node_name])
        if raised:
            return f'{raised}, so fix that first'
        if any(_NAN.search(text) for text in self._texts('INFO')):
            return 'an angle is nan, which is no number, so check how it is computed'
        if self._answer and not angles.missing(self._answer, self.numbers()):
            return EARLIER
        if self._has('INFO') or not self._has('WARN'):
            return angles.what_to_try(wanted, self.numbers())
        elsewhere = not angles.missing(wanted, self.numbers('WARN'), angles.ROUNDED_DEG)
        return INFO_FOR_ANGLES if elsewhere else WARN_ONLY

    def _why_unwarned(self) -> str:
        raised = what_raised([self._node_name])
        if raised and 'ValueError' not in raised:
            return f'{raised}, so fix that first'
        if self.records:
            return 'a target out of reach needs the level WARN: self.get_logger().warning(…)'
        return (
            f'catch ValueError each time and log it with self.get_logger().warning(…) {angles.HOW}'
        )

    def _expect_no_table(self) -> None:
        count = len(set(self.numbers()))
        if count > answers.MOST_NUMBERS:
            fail(
                expected=f'the angles of one target in the INFO log of {self._node_name}',
                seen=f'{count:,} different numbers',
                hint='log the solutions of each target, and not all possible angles',
                cause=f'over {answers.MOST_NUMBERS:,} different numbers for one target',
            )

    def _texts(self, level: str) -> list[str]:
        return [record.text for record in self.records if record.level == level]

    def _has(self, level: str) -> bool:
        return self._count(level) > 0

    def _count(self, level: str) -> int:
        return sum(record.level == level for record in self.records)

    def _shown(self, level: str) -> str:
        if texts := self._texts(level):
            return f"'{shorten(' | '.join(texts))}'"
        others = ' | '.join(f'{record.level} {record.text}' for record in self.records)
        return f'no {level} record' + (f" but '{shorten(others)}'" if others else '')
