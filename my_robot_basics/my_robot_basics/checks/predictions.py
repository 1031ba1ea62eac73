"""Predictions of what arrives, held against what does: the check runs each situation itself."""

import difflib
from collections.abc import Callable, Sequence

from my_robot_basics.checks import student
from my_robot_basics.checks.errors import expect, fail, shorten
from my_robot_basics.checks.stage import Stage, watchers

Situation = Callable[[Stage], bool]
"""Runs on an empty stage, and returns whether the message arrived; named as its prediction is.

Its docstring is what to think of where the prediction is wrong.
"""


class Predictions:
    """The notebook's dict of that name: for each key True (the message arrives) or False."""

    def __init__(self, name: str, keys: Sequence[str]) -> None:
        """Ask for the dict. Raises CheckFailed unless it holds a bool for each of the keys.

        Keys of the student's own beside these do no harm.
        """
        self._values = student.value(name, type=dict)
        for key in keys:
            if key not in self._values:
                fail(
                    expected=f'the key {key!r} in `{name}`',
                    seen=self._instead_of(key, keys),
                    hint='write the keys as in the table, letter for letter',
                )
            self._check_bool(key)

    def compare(self, *situations: Situation) -> None:
        """Run the situations until one goes otherwise than predicted. Raises CheckFailed."""
        with watchers() as participants:
            for situation in situations:
                key = situation.__name__
                arrived = situation(Stage(*participants))
                what = 'the message arrived' if arrived else 'the message did not arrive'
                expect(
                    self._values[key] is arrived,
                    expected=f'{arrived} for {key!r} ({what} when this was run)',
                    seen=self._values[key],
                    hint=situation.__doc__,
                )

    def _instead_of(self, key: str, keys: Sequence[str]) -> str:
        others = [other for other in self._values if isinstance(other, str) and other not in keys]
        similar = difflib.get_close_matches(key, others, n=1)
        return shorten(repr(*similar)) if similar else 'no such key'

    def _check_bool(self, key: str) -> None:
        found = self._values[key]
        if isinstance(found, bool):
            return
        hint = 'write True if the message arrives and False if not'
        if isinstance(found, str):
            hint += ', without quotes'
        if found is None:
            hint = 'put your prediction, True or False, in place of None'
        fail(expected=f'True or False for {key!r}', seen=shorten(repr(found), 60), hint=hint)
