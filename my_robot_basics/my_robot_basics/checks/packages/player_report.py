"""The report of `arm_player` on `/arm_player/done`: one latched message, a word per target."""

import re
from collections.abc import Sequence

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from my_robot_basics.checks.packages.packages import RunningExecutable
from my_robot_basics.checks.packages.player_servers import WORDS
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher

TOPIC = '/arm_player/done'
TYPE = 'std_msgs/msg/String'
LATE_SEC = 4.0
"""How long the report may take to reach a late-joining subscription, in s of free time."""
STAYS_SEC, MOST_STAYS_SEC = 2.5, 3.5
"""How long after its report a node has to run on, in s of free time, and in s of wall time at
most. Some sleep for a second or two, and then return from main; 5 s are never noticed."""
DEPTH = 100
ANY = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_SPELT = {'cancelled': 'canceled', 'cancel': 'canceled', 'succeed': 'succeeded'}


class PlayerReport:
    """Subscribes to the report twice: with BEST_EFFORT and, if that is offered, TRANSIENT_LOCAL.

    The second one is needed because a node may create the publisher only for the report, and
    then publishes before it has discovered any subscription.
    """

    topic_name = TOPIC

    def __init__(self, watcher: Watcher) -> None:
        """Subscribe from now on."""
        self._watcher = watcher
        self._any = _recorder(watcher, ANY)
        self._kept: Recorder | None = None

    def is_there(self) -> bool:
        """Whether a report has come; subscribes with TRANSIENT_LOCAL once that is offered."""
        if self._kept is None and self._is_published() and not self.why_none():
            self._kept = _recorder(self._watcher, LATCHED)
        return bool(self._messages())

    def comes_to_stay(self, *, free_sec: float) -> bool:
        """Whether a report comes within `free_sec`; if so, returns STAYS_SEC later."""
        is_there = self._watcher.spin_until_free(self.is_there, free_sec=free_sec)
        if is_there:
            self._let_stay(STAYS_SEC)
        return is_there

    def has_come(self) -> bool:
        """Whether a report has come by now."""
        return bool(self._messages())

    def has_come_twice(self) -> bool:
        """Whether more than one message has come by now."""
        return len(self._messages()) > 1

    def expect_once(self) -> None:
        """No second report has come. Raises CheckFailed."""
        expect(
            not self.has_come_twice(),
            expected=f'one message on {TOPIC}',
            seen=f'{len(self._messages())}',
            hint='publish the report once: late-joining subscriptions receive it from the '
            'publisher, too',
            cause='the report is published again',
        )

    def expect_none_yet(self) -> None:
        """No report has come so far, as a goal has not ended yet. Raises CheckFailed."""
        said = self._messages()[-1:]
        expect(
            not said,
            expected=f'no message on {TOPIC} before the last target is done',
            seen=f"'{student_text(shorten(said[0]))}'" if said else '',
            hint='publish one report, when the result of the last goal is there',
            cause='the report comes too soon',
        )

    def expect_words(self, words: Sequence[str]) -> None:
        """The report consists of these words, one for each target. Raises CheckFailed."""
        said = self._messages()[-1]
        seen = re.findall(r'\w+', said)
        if seen != [*words]:
            fail(
                expected=f"'{' '.join(words)}' on {TOPIC}",
                seen=f"'{student_text(shorten(said))}'",
                hint=_why_wrong(seen, words),
                cause='the report says something else',
            )

    def expect_kept(self, process: RunningExecutable, *, stays_sec: float = 0.0) -> None:
        """A subscription that joins `stays_sec` later receives it, too. Raises CheckFailed."""
        self._let_stay(stays_sec)
        process.expect_running()
        why = self.why_none()
        expect(
            not why and self._is_sent_again(),
            expected=f'the report on {TOPIC} for a subscription that joins after it',
            seen='none',
            hint=why or 'let the node and its publisher exist until Ctrl-C: rclpy.spin',
            cause='the report is not kept',
        )

    def why_none(self) -> str:
        """Why publishers of the topic do not deliver a report (type, QoS), as advice; or ''."""
        infos = graphs.publisher_infos(self._watcher.node, TOPIC)
        types = sorted({info.topic_type for info in infos})
        if types and types != [TYPE]:
            return f'use {TYPE} there, and not {student_text(" and ".join(types))}'
        if any(i.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL for i in infos):
            return 'give the publisher the durability TRANSIENT_LOCAL, as in lesson 6'
        if any(i.qos_profile.reliability != ReliabilityPolicy.RELIABLE for i in infos):
            return 'give the publisher the reliability RELIABLE: a lost report is not sent again'
        return ''

    def _let_stay(self, free_sec: float) -> None:
        most = {'free_sec': free_sec, 'wall_sec': MOST_STAYS_SEC}
        self._watcher.spin_until_free(lambda: False, **most)

    def _is_published(self) -> bool:
        return bool(graphs.publisher_infos(self._watcher.node, TOPIC))

    def _is_sent_again(self) -> bool:
        with Watcher() as late:
            recorder = _recorder(late, LATCHED)
            return late.spin_until_free(lambda: bool(recorder.received), free_sec=LATE_SEC)

    def _messages(self) -> list[str]:
        recorders = filter(None, (self._kept, self._any))
        return next(([m.data for m in each.messages()] for each in recorders if each.received), [])


def _recorder(watcher: Watcher, qos_profile: QoSProfile) -> Recorder:
    return Recorder(watcher, topic_name=TOPIC, type_=String, qos_profile=qos_profile)


def _why_wrong(seen: Sequence[str], words: Sequence[str]) -> str:
    lower = [_SPELT.get(word.lower(), word.lower()) for word in seen]
    if lower == [*words]:
        return f'write the words as the task does: {", ".join(WORDS)}'
    if re.findall('|'.join(WORDS), ' '.join(seen)) == [*words]:
        return f'write these words alone, with a space between: {", ".join(WORDS)}'
    if any(word.isdigit() for word in seen):
        return 'write the word for each status, and not its number'
    if len(seen) < len(words):
        return 'report on every target, in one message: unreachable and rejected ones, too'
    if not {*lower} <= {*WORDS}:
        return f'write these words alone, with a space between: {", ".join(WORDS)}'
    return 'one word for each target, in their order: the status of the result tells how it ended'
