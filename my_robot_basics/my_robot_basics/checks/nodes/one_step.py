"""A parameter that is set together with another one: the node's callback gets both in one list."""

from typing import NoReturn

from my_robot_basics.checks.nodes.parameter_refusals import fail_refused, in_its_type
from my_robot_basics.checks.nodes.parameters import NodeParameters
from my_robot_basics.feedback.errors import CheckFailed, expect, fail


def expect_refused(parameters: NodeParameters, name: str, kept_hz: float, rate_hz: float) -> None:
    """The node refuses this value, too, if it is set atomically with use_sim_time.

    Both orders in the list are tried. Afterwards the parameter must still be `kept_hz`. Raises
    CheckFailed.
    """
    [value] = in_its_type(parameters, name, [rate_hz], kept_hz)
    for is_first in (False, True):
        parameters.set_beside_another(name, value, is_first=is_first)
        both = f'{name} = {value:g}', 'use_sim_time'
        first, second = both if is_first else reversed(both)
        expect(
            parameters.get(name) == kept_hz,
            expected=f'{first} and {second}, set in one step, to be refused because of {name}',
            seen='it was accepted',
            hint='your callback gets a list of all that is set in one step: go through all of it, '
            'refuse if any value is wrong, and accept after the loop',
            cause='a value outside the limits is accepted beside another parameter',
        )


def expect_taken(parameters: NodeParameters, name: str, rate_hz: float) -> None:
    """The node accepts this value behind use_sim_time in one list. Raises CheckFailed."""
    [value] = in_its_type(parameters, name, [rate_hz])
    result = parameters.set_beside_another(name, value)
    if not result.successful:
        fail_refused(name, value, result)


def fail_unchanged(
    name: str, seen_hz: float, now_hz: float, *, doubt: type[CheckFailed]
) -> NoReturn:
    """Raise CheckFailed: the rate did not change when both parameters were set in one step."""
    fail(
        expected=f'{now_hz:g} Hz after use_sim_time and {name} were set in one step',
        seen=f'{seen_hz:.3g} Hz as before',
        hint='your callback gets a list of all that is set in one step: go through all of it',
        cause=f'the rate does not follow {name} beside another parameter',
        doubt=doubt,
    )
