"""An executable that a check has started in the student's room: a process, and a node over DDS.

Whether the process runs and how it ended is only that room's claim. DDS shows the node itself.
"""

import time
from collections.abc import Mapping
from functools import partial
from typing import Any, NoReturn, Self

from my_robot_basics.checks.clock.doubts import doubt_after
from my_robot_basics.checks.packages import package_words, polite_end, spinning
from my_robot_basics.checks.services.services import answers_parameters
from my_robot_basics.exchange import student
from my_robot_basics.exchange.endings import is_clean, why_crashed
from my_robot_basics.feedback.errors import Starved, expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

NODE_SEC = 10.0
"""How long an executable's node may take to appear, in seconds of free time."""
END_SEC = 5.0
"""How long a process may take to end after SIGINT, in s of free time, as with ros2 launch."""
GONE_SEC = 8.0
"""How long its node may stay on the graph, in s of free time: DDS's lease of 5 s and a margin."""
ASK_EVERY_SEC, ASK_END_EVERY_SEC = 0.3, 0.05
"""How often to ask the notebook whether the process has ended: normally, and if it should end."""


class RunningExecutable:
    """One process of the student's package, for the duration of a with statement."""

    def __init__(self, package: str, executable: str, arguments: tuple[str, ...]) -> None:
        """Prepare the process; the `with` statement starts it."""
        self.package, self.executable, self.arguments = package, executable, arguments
        self._is_second = False
        self._number: int | None = None
        self._nodes: list[str] = []
        self._next_question, self._ask_every_sec = 0.0, ASK_EVERY_SEC
        self._watcher: Watcher
        """Exists as long as the process: only a node that was discovered can be seen to leave."""

    def __enter__(self) -> Self:
        """Start the process. Raises CheckFailed if that fails."""
        told = self._ask('start', self.executable, list(self.arguments))
        number = told.get('number')
        if type(number) is not int:
            problem = package_words.text_in(told, 'problem')
            fail(
                expected=f'{self.executable} of {self.package} to start',
                seen='no process',
                hint=student_text(shorten(problem, 400)) or f"run build_package('{self.package}')",
                cause=f'{self.executable} could not be started',
            )
        self._number = number
        self._watcher = Watcher().__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        """End the process if it still runs; this affects no verdict."""
        send = partial(self._ask, 'signal', self._number)
        polite_end.end(send, lambda: self._ask('state', self._number).get('code') is not None)
        self._watcher.__exit__(*error)

    def expect_node(self, node_name: str) -> None:
        """A node of that full name, such as '/arm_driver', appears. Raises CheckFailed."""
        watcher, watch = self._watcher, Stopwatch()

        def is_there() -> bool:
            return node_name in graphs.node_names(watcher.node)

        watcher.spin_until_free(lambda: is_there() or self._has_ended(), free_sec=NODE_SEC)
        if not is_there():
            doubt = doubt_after(watch, NODE_SEC)
            wanted = f'the node {node_name} of {self.executable}'
            names = graphs.take_snapshot(watcher).nodes()
            if self._state()[0] is not None:
                self._fail_ended(wanted)
            fail(
                expected=wanted,
                seen=student_text(shorten(', '.join(names))) or 'no node',
                hint="look at super().__init__('…') of its class, and at what main does before",
                cause=f'there is no node {node_name}',
                doubt=doubt,
            )
        self._nodes.append(node_name)

    def expect_running(self) -> None:
        """The process still runs. Otherwise raises CheckFailed with the last line it printed."""
        if self._state()[0] is not None:
            self._fail_ended(f'{self.executable} to go on running')

    def expect_end(self, *, code: int = 0, within_sec: float = 10.0) -> None:
        """The process ends by itself with that exit code, within `within_sec` s of free time.

        Raises CheckFailed.
        """
        wanted = f'{self.executable} to end by itself'
        self._wait_for_end(wanted, within_sec, hint='let main return when it is done')
        hint = 'let main return without an exception when it is done'
        self._expect_code(code, hint=why_crashed(self._state()[0]) or hint)

    def expect_clean_end(self) -> None:
        """The process ends after SIGINT (Ctrl-C) with exit code 0, and its nodes disappear.

        Raises CheckFailed: the process still runs, or with its exit code and the last line.
        """
        self.expect_running()
        spinning.wait_until_they_spin(self._watcher, self._nodes)
        self._ask('signal', self._number, 'SIGINT')
        self._wait_for_end(f'{self.executable} to end after SIGINT', END_SEC)
        code, said = self._state()
        if not is_clean(code, said.splitlines(), is_second=self._is_second):
            self._expect_code(0, hint=package_words.why_not_clean(code, said))
        self._expect_gone()
        if code and not self._is_second:
            self._expect_clean_second_end()

    def _expect_clean_second_end(self) -> None:
        """End a second process: rclpy's race at shutdown excuses an exit code 1 only once."""
        with RunningExecutable(self.package, self.executable, self.arguments) as second:
            second._is_second = True
            for name in self._nodes:
                second.expect_node(name)
            second.expect_clean_end()

    def _wait_for_end(self, expected: str, free_sec: float, *, hint: str = '') -> None:
        watch = Stopwatch()
        self._ask_every_sec, self._next_question = ASK_END_EVERY_SEC, 0.0
        if not self._watcher.spin_until_free(self._has_ended, free_sec=free_sec):
            fail(
                expected=expected,
                seen=f'it still runs after {free_sec:g} s',
                doubt=doubt_after(watch, free_sec),
                hint=hint or package_words.why_it_goes_on(self._ask('handlers')),
                cause=f'{self.executable} does not end',
            )

    def _expect_code(self, wanted: int, *, hint: str) -> None:
        code, said = self._state()
        wanted_end = f'{self.executable} to end with exit code {wanted}'
        seen = ', '.join(
            filter(None, (package_words.describe_exit(code), package_words.last_words(said)))
        )
        cause = f'{self.executable} does not end cleanly'
        expect(code == wanted, expected=wanted_end, seen=seen, hint=hint, cause=cause)

    def _expect_gone(self) -> None:
        watch = Stopwatch()
        for name in self._nodes:
            is_gone = partial(graphs.is_gone, self._watcher, name)
            if self._watcher.spin_until_free(is_gone, free_sec=GONE_SEC):
                continue
            doubt = doubt_after(watch, GONE_SEC)
            fail(
                expected=f'{name} to be gone from the graph',
                seen='it is still there',
                hint='let main end all that it has started',
                cause=f'{name} keeps running',
                doubt=doubt if answers_parameters(self._watcher, name) else Starved,
            )

    def _fail_ended(self, expected: str) -> NoReturn:
        code, said = self._state()
        fail(
            expected=expected,
            seen=package_words.describe_end(code, said),
            hint=package_words.why_ended(code, self.package, self.executable),
            cause=f'{self.executable} ends by itself',
        )

    def _has_ended(self) -> bool:
        """Whether the process has ended; asks the notebook at most once per interval."""
        if time.monotonic() < self._next_question:
            return False
        self._next_question = time.monotonic() + self._ask_every_sec
        return self._state()[0] is not None

    def _state(self) -> tuple[int | None, str]:
        """The exit code (None while the process runs) and the last lines that it printed."""
        told = self._ask('state', self._number)
        code = told.get('code')
        if type(code) is not int and 'code' not in told:
            fail(
                expected=f'{self.executable} to run in the notebook',
                seen='no answer of the notebook about it',
                hint='look for a kernel that has died, or that is kept busy',
                cause=f'nothing is known of {self.executable}',
            )
        return code if type(code) is int else None, package_words.text_in(told, 'said')

    def _ask(self, verb: str, *args: object) -> Mapping[str, Any]:
        return student.ask_package(self.package, verb, *args)
