"""Interface definitions that a notebook holds as texts, compared with the right ones."""

from collections.abc import Mapping
from pathlib import PurePosixPath

from my_robot_basics.checks.values.definition_differences import differences, wrong_names
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import CheckFailed, fail, shorten
from my_robot_basics.feedback.hidden import is_quiet, leave_quiet_mode, tell_failed_already
from my_robot_basics.ros2.definitions import Definition, read_definition

TO_SHOW: tuple[str, ...] = ('in `{name}`, {faults}',)
"""How a message lists the faults of a text."""
MOST_FAULTS = 3
"""How many faults of a text a message lists; students do not fix more at once."""


class Definitions:
    """Variables of a notebook whose values are the texts of one package's interface files.

    ```python
    texts = Definitions('motor_interfaces', motor_msg='msg/Motor.msg')
    texts.expect_names(motor_msg='speed temperature')
    texts.expect_definitions(motor_msg=MOTOR)  # MOTOR is the text of the right file
    texts.conclude({'motor_msg': 2.0})
    ```

    `conclude` reports all faults together. Each text has its own points, so that a fault in one
    costs no points of the others.
    """

    def __init__(self, package: str, **files: str) -> None:
        """Read the texts from the notebook; `files`: the path in the package, by variable name."""
        self._package = package
        self._files = {name: PurePosixPath(file) for name, file in files.items()}
        self._own_types = frozenset(
            path.stem for path in self._files.values() if path.suffix == '.msg'
        )
        self._faults: dict[str, list[str]] = {name: [] for name in files}
        self._missing: list[CheckFailed] = []
        self._failed_already = False
        self._compared: set[str] = set()
        self._texts = {name: self._read(name) for name in files}

    def expect_names(self, **names: str) -> None:
        """Expect each text to have exactly these fields and constants, with --- between its parts.

        If rosidl rejects a text, only this is reported about it.
        """
        for text, wanted in names.items():
            found = self._texts[text]
            parts = [part.split() for part in wanted.split('---')]
            if found and not self._faults[text]:
                self._add(text, found.faults or wrong_names(found, parts, self._kind(text)))

    def expect_definitions(self, **definitions: str) -> None:
        """Expect each text to define the same as the given one, in any order within a part.

        Types, arrays, constants and default values are compared; comments are not.
        """
        for text, definition in definitions.items():
            found, wanted = self._texts[text], self._parsed(text, definition)
            if wanted.faults:
                raise ValueError(f'the definition for {text} is none: {wanted.faults}')
            self._compared.add(text)
            if found and not self._faults[text]:
                self._add(text, found.faults or differences(found, wanted, self._kind(text)))

    def conclude(self, points: Mapping[str, float]) -> None:
        """Raise CheckFailed if a text is wrong; the message says what is wrong in each.

        `points`: what each text is worth. Correct texts earn their points only if all texts have
        been compared by `expect_definitions`.
        """
        wrong = [name for name, faults in self._faults.items() if faults]
        if not wrong:
            return
        if self._failed_already:
            tell_failed_already()
        has_all = self._compared == set(self._files)
        right = [name for name in self._files if name not in wrong]
        earned = sum(points[name] for name in right) if has_all else 0.0
        if len(self._missing) == len(self._files):
            raise self._missing[0]
        shown, most = ' and '.join(f'`{name}`' for name in wrong), sum(points.values())
        seen = f'something else in {shown}'
        if earned:
            seen = f'something else in {shown}, which leaves {earned:g} of {most:g} points'
        # the message quotes only the task's table and the student's text, no hidden input
        with leave_quiet_mode():
            fail(
                expected='each text to define what its table says',
                seen=seen,
                hint='; '.join(self._faults_in_words(name) for name in wrong),
                earned=earned,
            )

    def _read(self, name: str) -> Definition | None:
        try:
            text = student.value(name, type=str)
        except CheckFailed as failure:
            self._missing.append(failure)
            self._add(name, [shorten(failure)])
            return None
        return self._parsed(name, text)

    def _parsed(self, name: str, text: str) -> Definition:
        return read_definition(
            text, package=self._package, kind=self._kind(name), own_types=self._own_types
        )

    def _kind(self, name: str) -> str:
        return self._files[name].suffix.removeprefix('.')

    def _add(self, name: str, faults: list[str]) -> None:
        self._faults[name] += faults
        self._failed_already |= bool(faults) and not is_quiet()

    def _faults_in_words(self, name: str) -> str:
        faults = self._faults[name]
        rest = len(faults) - MOST_FAULTS
        more = [f'and {rest} more'] if rest > 0 else []
        return f'in `{name}`, ' + '; '.join([*faults[:MOST_FAULTS], *more])
