"""The log of one node: its records on /rosout since a given time."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

from rcl_interfaces.msg import Log as LogMessage
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

from my_robot_basics.checks.nodes.node_names import why_absent
from my_robot_basics.checks.nodes.sleepers import PatientWait
from my_robot_basics.checks.recordings.callbacks import CallbackErrors
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.checks.values import answers
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.graph import graphs
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.watcher import Watcher

LEVELS = {10: 'DEBUG', 20: 'INFO', 30: 'WARN', 40: 'ERROR', 50: 'FATAL'}
DEPTH = 1000
NODE_SEC = 10.0
GONE_SEC = 1.0
"""How long a running node may be missing from the graph, in seconds of wall time."""
MOST_CHARACTERS = 400_000
"""How much a node may log for one target: each new record makes the check read all of it again."""


@dataclass(frozen=True)
class Record:
    """One log record."""

    level: str
    """'DEBUG', 'INFO', 'WARN', 'ERROR' or 'FATAL'."""
    text: str
    """The message as the node logged it, without the time and the logger's name."""


class NodeLog:
    """A context manager that subscribes to one node's log.

    Only records logged since the last `mark()` count; entering the `with` block sets the first
    one. /rosout is latched, so older records arrive, too: they answer earlier targets.
    """

    def __init__(self, node_name: str) -> None:
        """Use `with rosout(node_name) as log`; the `with` statement subscribes to /rosout."""
        self._logger = node_name.strip('/').replace('/', '.')
        self.node_name = f'/{node_name.strip("/")}'
        self._received: list[tuple[int, Record]] = []
        self._watcher = Watcher()
        self.wait = PatientWait(self._watcher, self.node_name)
        self._since_ns = self._characters = 0
        self._publishers: dict[str, Publisher] = {}
        self._asked: tuple[str, Any] | None = None
        """The topic and the message of the last `ask`."""
        self.asked_again = False
        """Whether the last `ask` had the same topic and message as the one before it."""

    def __enter__(self) -> Self:
        """Subscribe and wait for the node. Raises CheckFailed if it does not appear."""
        self._watcher.__enter__()
        try:
            self._meet()
        except BaseException as error:
            self._watcher.__exit__(type(error), error, None)
            raise
        self.mark()
        self._raised = CallbackErrors([self.node_name])
        return self

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        """Destroy the subscription."""
        self._watcher.__exit__(kind, error, traceback)

    def mark(self) -> None:
        """Count only records that are logged from now on."""
        self._since_ns, self._characters = time.time_ns(), 0

    def ask(self, topic_name: str, message: Any) -> None:
        """Set the mark, then publish a target: `records` should answer this target only.

        Raises CheckFailed if the topic has no subscription.
        """
        if topic_name not in self._publishers:
            publisher = Topic(topic_name).meet(self._watcher, type(message))
            self._publishers[topic_name] = publisher
        self.mark()
        self.asked_again = self._asked == (topic_name, message)
        self._asked = topic_name, message
        self._publishers[topic_name].publish(message)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records that were logged since the mark, oldest first."""
        return tuple(record for sent_ns, record in self._received if sent_ns > self._since_ns)

    def numbers(self, level: str = 'INFO', *, since: int = 0) -> tuple[float, ...]:
        """All numbers in the records of a level since the mark, in order.

        `since`: how many of these records to skip.
        """
        texts = self.texts(level)[since:]
        return tuple(number for text in texts for number in answers.numbers_of(text))

    def wait_for(self, done: Callable[[Self], bool], *, timeout_sec: float = 5.0) -> bool:
        """Spin until `done(log)` or for `timeout_sec` of wall time; return whether it is done."""
        return self._watcher.spin_until(lambda: done(self), timeout_sec=timeout_sec)

    def wait_for_answer(self, done: Callable[[Self], bool], *, free_sec: float) -> bool:
        """Spin until `done(log)`, as `PatientWait` does; return whether it is done."""
        return self.wait.until(lambda: done(self), free_sec=free_sec)

    def _meet(self) -> None:
        node = self._watcher.node
        latched = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(LogMessage, '/rosout', with_info(self._receive), latched)

        is_settled = graphs.is_settled(self._watcher, self.node_name)
        timeout_sec = graphs.SETTLED_SEC if is_settled else NODE_SEC
        if not self._watcher.spin_until(self._is_there, timeout_sec=timeout_sec):
            others = graphs.take_snapshot(self._watcher).nodes()
            expect(
                self.node_name not in others,
                expected=f'the log of {self.node_name} on /rosout',
                seen='none',
                hint='leave enable_rosout=False out of super().__init__(…): it turns the log off',
            )
            fail(
                expected=f'a node {self.node_name}',
                seen=', '.join(others) or 'no node',
                hint=why_absent(self.node_name, others),
            )

    def expect_node(self) -> None:
        """The node still runs. Raises CheckFailed."""
        expect(
            self._watcher.spin_until(self._is_there, timeout_sec=GONE_SEC),
            expected=f'{self.node_name} to go on after each target',
            seen='it has ended',
            hint='leave rclpy.shutdown(), destroy_node() and exit() out of the callback',
            cause='the node has ended',
        )

    def _is_there(self) -> bool:
        infos = self._watcher.node.get_publishers_info_by_topic('/rosout')
        return self.node_name in map(graphs.full_name, infos)

    def _receive(self, message: LogMessage, info: dict) -> None:
        if message.name == self._logger or message.name.startswith(f'{self._logger}.'):
            level = LEVELS.get(message.level, str(message.level))
            sent_ns = info['source_timestamp']
            self._received.append((sent_ns, Record(level, message.msg)))
            if sent_ns > self._since_ns > 0:
                self._expect_few_characters(len(message.msg))

    def _expect_few_characters(self, more: int) -> None:
        self._characters += more
        expect(
            self._characters <= MOST_CHARACTERS,
            expected=f'the answer to one target in the log of {self.node_name}',
            seen=f'{self._characters:,} characters',
            hint='log the solutions of each target, in a line or a few',
            cause=f'over {MOST_CHARACTERS:,} characters for one target',
        )

    def texts(self, level: str) -> list[str]:
        """The texts of a level since the mark, in order."""
        return [record.text for record in self.records if record.level == level]

    def has(self, level: str) -> bool:
        """Whether there is a record of a level since the mark."""
        return self.count(level) > 0

    def count(self, level: str) -> int:
        """How many records of a level there are since the mark."""
        return sum(record.level == level for record in self.records)

    def shown(self, level: str) -> str:
        """What to show of a level: its texts, or the records of other levels if it has none."""
        if texts := self.texts(level):
            return f"'{shorten(' | '.join(texts))}'"
        others = ' | '.join(f'{record.level} {record.text}' for record in self.records)
        return f"no {level} record but '{shorten(others)}'" if others else f'no {level} record'
