"""Compare predictions of what arrives with what does arrive: the check runs each situation."""

import difflib
from collections.abc import Callable, Mapping, Sequence

from my_robot_basics.checks.values.delivery_experiment import Stage, watchers
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.hidden import is_quiet, leave_quiet_mode, tell_failed_already

Situation = Callable[[Stage], bool]
"""A function with a prediction's name that runs on an empty stage; returns if the message arrived.

Its docstring is the reason that the student reads if the prediction is wrong.
"""


class Predictions:
    """The notebook's dict of that name: for each key True (the message arrives) or False.

    ```python
    def late(stage):
        '''a VOLATILE publisher keeps nothing for subscribers that come later'''
        message = stage.publisher('/pose').publish()
        return stage.subscription('/pose').received(message)

    predictions = Predictions('answers', ['late'])
    predictions.run(late)
    predictions.conclude({1: 2.0})
    ```
    """

    def __init__(self, name: str, keys: Sequence[str]) -> None:
        """Get the dict. Raises CheckFailed unless it has a bool for each of the keys.

        Additional keys in the student's dict are ignored.
        """
        self._keys = tuple(keys)
        self._ran = 0
        self._wrong: list[tuple[Situation, bool]] = []
        self._failed_already = False
        self._values = student.value(name, type=dict)
        for key in keys:
            if key not in self._values:
                fail(
                    expected=f'the key {key!r} in `{name}`',
                    seen=self._instead_of(key, keys),
                    hint='write the keys as in the table, letter for letter',
                )
            self._check_bool(key)

    def run(self, *situations: Situation) -> None:
        """Run the situations, and remember those whose result differs from the prediction."""
        with watchers() as participants:
            for situation in situations:
                arrived = situation(Stage(*participants))
                self._ran += 1
                if self._values[situation.__name__] is not arrived:
                    self._wrong.append((situation, arrived))
                    self._failed_already |= not is_quiet()

    def conclude(self, points: Mapping[int, float]) -> None:
        """Raise CheckFailed, naming each wrong prediction and the reason, if there are any.

        `points` maps the least number of right predictions to the points that are left, once all
        situations have run. Choose them so that guessing earns almost none.
        """
        if not self._wrong:
            return
        if self._failed_already:
            tell_failed_already()
        right = self._ran - len(self._wrong)
        has_all = self._ran == len(self._keys)
        earned = max((p for least, p in points.items() if has_all and right >= least), default=0)
        reasons = [
            _what_happened(f'`{each.__name__}`', each.__doc__ or '', arrived=arrived)
            for each, arrived in self._wrong
        ]
        # safe to show: what happens on the check's own stage, and the student's own answers
        with leave_quiet_mode():
            fail(
                expected='each prediction to match what happens when the check runs it',
                seen=self._how_many_wrong(earned, max(points.values())),
                hint='; '.join(reasons),
                earned=earned,
            )

    def _how_many_wrong(self, earned: float, most: float) -> str:
        if self._ran < len(self._keys):
            return f'{len(self._wrong)} of the {self._ran} that this part runs wrong'
        if earned:
            return f'{len(self._wrong)} wrong, which leaves {earned:g} of {most:g} points'
        return f'{len(self._wrong)} wrong'

    def _instead_of(self, key: str, keys: Sequence[str]) -> str:
        others = [other for other in self._values if isinstance(other, str) and other not in keys]
        by_letters = {other.lower(): other for other in others}
        similar = difflib.get_close_matches(key, by_letters, n=1)
        return shorten(repr(by_letters[similar[0]])) if similar else 'no such key'

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


def _what_happened(message: str, why: str, *, arrived: bool) -> str:
    if arrived:
        return f'{message} arrives ({why})'
    return f'{message} does not arrive ({why})'
