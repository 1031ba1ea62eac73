"""A node's answer to a new parameter value: it accepts the value, or refuses it with a reason."""

import math
from collections.abc import Sequence
from typing import NoReturn

from rcl_interfaces.msg import SetParametersResult

from my_robot_basics.checks.nodes.parameters import NodeParameters
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text

_NO_RESULT = 'Callback returned an invalid type'
"""rclpy's reason if a callback does not return a SetParametersResult."""
_READ_ONLY = 'read-only'
"""rclpy's reason contains this if the parameter is declared as read-only."""
_OF_ANOTHER_TYPE = 'Wrong parameter type'
"""rclpy's reason begins with this if the parameter is declared with another type."""
_IS_TEXT = "expected 'Type.STRING'"


def expect_all_refused(
    parameters: NodeParameters, name: str, kept_hz: float, rates_hz: Sequence[float]
) -> None:
    """The node refuses each of these values with a reason, and the parameter stays `kept_hz`.

    Raises CheckFailed.
    """
    tried = in_its_type(parameters, name, rates_hz, kept_hz)
    results = parameters.set(name, *tried)
    value = parameters.get_number(name)
    is_one_of_them = any(value == each or _are_nan(value, each) for each in (kept_hz, *tried))
    corrected = None if is_one_of_them else value
    for each, result in zip(tried, results, strict=True):
        _expect_refused(name, each, result, corrected=corrected)
    expect(
        value == kept_hz,
        expected=f'{name} = {kept_hz:g}, as before',
        seen=student_text(shorten(repr(value))),
        hint='change nothing when you refuse a value',
        cause=f'{name} is changed by a value that was refused',
    )


def expect_leaves_others_alone(parameters: NodeParameters, name: str) -> None:
    """The node's callback accepts parameters other than `name`: use_sim_time can still be set.

    Raises CheckFailed if use_sim_time cannot be set to the value that it has.
    """
    [result] = parameters.set('use_sim_time', parameters.get('use_sim_time'))
    if not result.successful:
        expect_a_result(result)
        [same] = parameters.set(name, parameters.get(name))
        _expect_yes_where_nothing_changes(name, same)
        reason = _in_code(result.reason)
        fail(
            expected='use_sim_time, another parameter, to be set',
            seen=f'it refused: `{reason}`',
            hint='your callback gets each parameter that is set: check only those whose name is '
            f"'{name}'",
            cause='your callback refuses other parameters',
        )


def _expect_yes_where_nothing_changes(name: str, result: SetParametersResult) -> None:
    """The node accepts a parameter's present value, or gives a reason. Raises CheckFailed."""
    expect(
        result.successful or bool(result.reason.strip()),
        expected=f'{name} to be set to the value that it has',
        seen='it refused, without a reason',
        hint='end your callback with return SetParametersResult(successful=True): `successful` is '
        'False unless you set it',
        cause='your callback refuses all values',
    )


def _expect_refused(
    name: str, value: float, result: SetParametersResult, *, corrected: float | None
) -> None:
    """The node refused a value with a reason. Raises CheckFailed.

    `corrected` is the parameter's value now if it is neither one of the values that the check set
    nor the earlier value; otherwise None.
    """
    is_corrected, is_nan = corrected is not None, math.isnan(value)
    how = "return SetParametersResult(successful=False, reason='…') for it"
    if is_corrected:
        how = f'do not correct the value, {how}'
    if is_nan:
        how = (
            'NaN is not a number, and comparing it with < or > always gives False: check whether '
            'a value is within the limits, and refuse it if not'
        )
    expect(
        not result.successful,
        expected=f'{name} = {value:g} to be refused',
        seen=f'it was accepted, and {name} is {corrected:g} in the end'
        if is_corrected
        else 'it was accepted',
        hint=how,
        cause='NaN is accepted' if is_nan else 'a value outside the limits is accepted',
    )
    expect(
        bool(result.reason.strip()),
        expected=f'a reason why {name} = {value:g} is refused',
        seen='none',
        hint="tell why: SetParametersResult(successful=False, reason='…')",
        cause='a value is refused without a reason',
    )


def in_its_type(
    parameters: NodeParameters, name: str, rates_hz: Sequence[float], kept_hz: float = math.inf
) -> list[float]:
    """The rates as integers if the parameter is an integer; those above kept_hz are rounded up.

    An integer parameter cannot hold inf and NaN, so these are left out then.
    """
    if isinstance(parameters.get(name), int):
        numbers = filter(math.isfinite, rates_hz)
        return [math.ceil(hz) if hz > kept_hz else int(hz) for hz in numbers]
    return [*rates_hz]


def _are_nan(*values: object) -> bool:
    return all(isinstance(value, float) and math.isnan(value) for value in values)


def fail_refused(name: str, value: float, result: SetParametersResult) -> NoReturn:
    """Raise CheckFailed: the node refused a value that it must accept."""
    expect_a_result(result)
    expect(
        bool(result.reason.strip()),
        expected=f'{name} = {value!r} to be set',
        seen='it refused, without a reason',
        hint='for values within the limits, return SetParametersResult(successful=True): '
        '`successful` is False unless you set it',
        cause='a value within the limits is refused',
    )
    is_type = result.reason.startswith(_OF_ANOTHER_TYPE)
    hint = (
        'refuse only what is outside the limits: any value within the limits and the limits '
        'themselves are allowed'
    )
    if is_type:
        hint = 'a parameter has the type of its default value: declare it with 5.0, not 5'
        if _IS_TEXT in result.reason:
            hint = "a parameter has the type of its default value: declare it with 5.0, not '5.0'"
    elif _READ_ONLY in result.reason:
        hint = 'nobody can set a read-only parameter: declare it without read_only=True'
    reason = _in_code(result.reason)
    fail(
        expected=f'{name} = {value!r} to be set',
        seen=f'it refused: `{reason}`',
        hint=hint,
        cause=f'{name} is not a double' if is_type else 'a value within the limits is refused',
    )


def expect_a_result(result: SetParametersResult) -> None:
    """The node's callback returned a SetParametersResult. Raises CheckFailed."""
    expect(
        result.reason != _NO_RESULT,
        expected='a SetParametersResult from your callback',
        seen='something else',
        hint='end each branch of it with return SetParametersResult(successful=…)',
        cause='your callback returns no SetParametersResult',
    )


def _in_code(reason: str) -> str:
    """Return a node's reason as it is shown between backticks: whatever it says, untranslated."""
    return student_text(shorten(reason).replace('`', "'"))
