"""A parameter that is a node's rate in Hz: the node follows it, and refuses some values."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from my_robot_basics.checks.nodes import one_step
from my_robot_basics.checks.nodes import parameter_refusals as refusals
from my_robot_basics.checks.nodes.parameters import NodeParameters, node_parameters
from my_robot_basics.checks.recordings import older_timers
from my_robot_basics.checks.recordings.older_timers import are_near
from my_robot_basics.checks.recordings.rate_failure import TOO_FAST_TIMES
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.recordings.sleeping_callbacks import why_too_slow
from my_robot_basics.checks.topics.topics import topic
from my_robot_basics.feedback.errors import CheckFailed, Starved, expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text

RECORD_SEC = 4.0
HOLD_PERIODS, HOLD_SEC = 3.0, 1.0
"""The simulated clock is held for HOLD_PERIODS of the expected rate, HOLD_SEC at most."""
UNCHANGED_PART = 0.25
"""A rate is unchanged within this part, even on a busy machine; refused values differ by more."""
ANOTHER_HZ = (4.0, 20.0, 8.0)
"""At least one of these differs from both rates that `_lags` has to tell apart."""


def rate_parameter(node_name: str, name: str, *, topic_name: str) -> 'RateParameter':
    """The parameter of that node that sets, in Hz, how often it publishes on the topic.

    Raises CheckFailed if there is no such node.
    """
    return RateParameter(node_parameters(node_name), name, topic_name)


@dataclass(frozen=True)
class RateParameter:
    """The assertions about a parameter that is a rate; each call takes a second or two."""

    parameters: NodeParameters
    name: str
    topic_name: str
    _taken_hz: list[float] = field(default_factory=list)

    def expect_default(self, rate_hz: float) -> None:
        """The parameter is a double with that value, and the node publishes at that rate."""
        refusals.expect_leaves_others_alone(self.parameters, self.name)
        value = self.parameters.get(self.name)
        expect(
            isinstance(value, int | float) and not isinstance(value, bool) and value == rate_hz,
            expected=f'{self.name} = {rate_hz}',
            seen=student_text(shorten(repr(value))),
            hint=f"declare it with its default: self.declare_parameter('{self.name}', {rate_hz}); "
            'if somebody has set it since, run the node again',
            cause=f'another default of {self.name}',
        )
        if isinstance(value, int):
            [result] = self.parameters.set(self.name, rate_hz)
            if not result.successful:
                refusals.fail_refused(self.name, rate_hz, result)
        self._record(rate_hz).assert_rate(rate_hz)

    def expect_takes(self, *rates_hz: float) -> None:
        """Each of these rates can be set, one after the other; the last one is the value then."""
        tried = refusals.in_its_type(self.parameters, self.name, rates_hz)
        for rate_hz, result in zip(tried, self.parameters.set(self.name, *tried), strict=True):
            if not result.successful:
                refusals.fail_refused(self.name, rate_hz, result)
        self._taken_hz.extend(tried)
        value = self.parameters.get(self.name)
        expect(
            value == tried[-1],
            expected=f'{self.name} = {tried[-1]:g}, which the node has accepted',
            seen=student_text(shorten(repr(value))),
            hint='accept the value as it is, or refuse it',
            cause=f'{self.name} has another value than the one that was set',
        )

    def expect_follows(self, *rates_hz: float, beside_another: bool = False) -> None:
        """The node publishes at each rate set, alone or (`beside_another`) with use_sim_time."""
        refusals.expect_leaves_others_alone(self.parameters, self.name)
        for rate_hz in rates_hz:
            before_hz = self.parameters.get_number(self.name)
            if beside_another:
                one_step.expect_taken(self.parameters, self.name, rate_hz)
            else:
                self.expect_takes(rate_hz)
            recording = self._record(rate_hz)
            try:
                recording.assert_rate(rate_hz)
            except CheckFailed as failed:
                if beside_another and are_near(recording.rate_hz, before_hz):
                    one_step.fail_unchanged(self.name, before_hz, rate_hz, doubt=type(failed))
                self._explain(failed, recording, before_hz, rate_hz)

    def expect_refuses(self, *rates_hz: float) -> None:
        """Each of these values is refused with a reason; the value and the rate do not change.

        NaN and inf are allowed here: they are tried last, and no rate is measured after them.
        """
        refusals.expect_leaves_others_alone(self.parameters, self.name)
        kept_hz = self.parameters.get_number(self.name)
        numbers = sorted(filter(math.isfinite, rates_hz), reverse=True)
        if numbers:
            self._expect_stays(kept_hz, numbers)
            one_step.expect_refused(self.parameters, self.name, kept_hz, numbers[0])
        for no_number in (hz for hz in rates_hz if not math.isfinite(hz)):
            self._expect_refused(kept_hz, [no_number])

    def _expect_stays(self, kept_hz: float, rates_hz: Sequence[float]) -> None:
        """The node refuses these values (the lowest one last), and its rate does not change."""
        self._expect_refused(kept_hz, rates_hz)
        seen_hz, _ = self._measure(kept_hz)
        if are_near(seen_hz, kept_hz, part=UNCHANGED_PART):
            return
        # the rate may have been wrong before: find out whether a refused value changes it
        if seen_hz > kept_hz and self._stays_at(seen_hz, kept_hz, rates_hz[0]):
            return
        self.parameters.set(self.name, kept_hz)
        before_hz, _ = self._measure(kept_hz)
        if before_hz > TOO_FAST_TIMES * kept_hz:
            return  # the node publishes as fast as it can, and that rate always varies
        self._expect_refused(kept_hz, rates_hz)
        after_hz, doubt = self._measure(kept_hz)
        expect(
            any(are_near(after_hz, hz, part=UNCHANGED_PART) for hz in (before_hz, kept_hz)),
            expected=f'the same rate as before a value is refused ({before_hz:.3g} Hz)',
            seen=f'{after_hz:.3g} Hz',
            hint='look at all values first, and change the timer only if none is refused',
            cause='a refused value changes the rate all the same',
            doubt=doubt,
        )

    def _stays_at(self, seen_hz: float, kept_hz: float, highest_hz: float) -> bool:
        """Whether setting the highest refused rate leaves the rate: older timers caused it."""
        self._expect_refused(kept_hz, [highest_hz])
        return are_near(self._measure(kept_hz)[0], seen_hz, part=UNCHANGED_PART)

    def _expect_refused(self, kept_hz: float, rates_hz: Sequence[float]) -> None:
        refusals.expect_all_refused(self.parameters, self.name, kept_hz, rates_hz)

    def _explain(
        self, failed: CheckFailed, recording: Recording, before_hz: float, now_hz: float
    ) -> NoReturn:
        """Raise CheckFailed with the reason why a node misses a new rate, else raise `failed`."""
        seen_hz = recording.rate_hz
        if are_near(seen_hz, now_hz) or why_too_slow(recording, now_hz):
            raise failed
        if are_near(seen_hz, before_hz + now_hz):
            seen = f'{seen_hz:.3g} Hz, which is both together'
            cause = 'the old timer still runs beside the new one'
            hint = 'call self.destroy_timer(…) for the old timer before you create the next one'
        elif not are_near(seen_hz, before_hz):
            older_timers.expect_none(self.name, seen_hz, self._taken_hz, failed=failed)
            raise failed
        elif self._lags(before_hz, now_hz):
            seen = f'{seen_hz:.3g} Hz, the value before'
            cause = 'the rate is one change behind'
            hint = (
                'while add_on_set_parameters_callback decides, get_parameter still returns the old'
                ' value: use parameter.value of the list that your callback gets'
            )
        else:
            seen = f'{seen_hz:.3g} Hz as before'
            cause = f'the rate does not follow {self.name}'
            hint = (
                'a timer keeps its period: when the parameter changes, destroy the timer and '
                'create another one, or set timer.timer_period_ns, in a callback without `async`: '
                'rclpy does not await it'
            )
        fail(
            expected=f'{now_hz:g} Hz after {self.name} went from {before_hz:g} to {now_hz:g}',
            seen=seen,
            hint=hint,
            cause=cause,
            doubt=type(failed),
        )

    def _lags(self, before_hz: float, now_hz: float) -> bool:
        """Whether the node is one change behind: the next change brings the rate `now_hz`."""
        others = [rate_hz for rate_hz in ANOTHER_HZ if not are_near(rate_hz, before_hz)]
        another_hz = next(rate_hz for rate_hz in others if not are_near(rate_hz, now_hz))
        self.expect_takes(another_hz)
        seen_hz, _ = self._measure(now_hz)
        return are_near(seen_hz, now_hz)

    def _record(self, rate_hz: float) -> Recording:
        """Record the topic, on which `rate_hz` is expected."""
        hold_sec = min(HOLD_PERIODS / max(1.0, rate_hz), HOLD_SEC)
        return topic(self.topic_name).record(seconds=RECORD_SEC, hold_sec=hold_sec)

    def _measure(self, rate_hz: float) -> tuple[float, type[CheckFailed]]:
        """The present rate in Hz (0 without messages), and the exception for a verdict on it."""
        try:
            recording = self._record(rate_hz)
        except CheckFailed:
            return 0.0, CheckFailed
        return recording.rate_hz, CheckFailed if recording.clock == 'simulated' else Starved
