"""What a node answers where somebody sets a parameter: taken, or refused for a reason."""

from typing import NoReturn

from rcl_interfaces.msg import SetParametersResult

from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import theirs

_NO_RESULT = 'Callback returned an invalid type'
"""rclpy's words, where a callback returns no SetParametersResult."""
_OF_ANOTHER_TYPE = 'Wrong parameter type'
"""How rclpy's reason begins, where a parameter is declared with another type."""


def expect_refused(
    name: str, value: float, result: SetParametersResult, *, corrected: float | None
) -> None:
    """A value was refused, with a reason. Raises CheckFailed.

    `corrected` is what the parameter has now, if that is neither a value that was set nor the one
    before.
    """
    is_corrected = corrected is not None
    how = "return SetParametersResult(successful=False, reason='…') for it"
    expect(
        not result.successful,
        expected=f'{name} = {value:g} to be refused',
        seen=f'it was taken, and {name} is {corrected:g}' if is_corrected else 'it was taken',
        hint=f'do not correct the value, {how}' if is_corrected else how,
        cause='a value outside the limits is taken',
    )
    expect(
        bool(result.reason.strip()),
        expected=f'a reason why {name} = {value:g} is refused',
        seen='none',
        hint="tell why: SetParametersResult(successful=False, reason='…')",
        cause='a value is refused without a reason',
    )


def fail_refused(name: str, value: float, result: SetParametersResult) -> NoReturn:
    """Raise CheckFailed, for a value that had to be taken."""
    expect_a_result(result)
    is_type = result.reason.startswith(_OF_ANOTHER_TYPE)
    fail(
        expected=f'{name} = {value!r} to be set',
        seen=f'it refused: {theirs(shorten(result.reason))}',
        hint='a parameter has the type of its default value: declare it with 5.0, not 5'
        if is_type
        else 'refuse only what is outside the limits; the limits themselves are allowed',
        cause=f'{name} is no double' if is_type else 'a value within the limits is refused',
    )


def expect_a_result(result: SetParametersResult) -> None:
    """The callback of the node returned a SetParametersResult. Raises CheckFailed."""
    expect(
        result.reason != _NO_RESULT,
        expected='a SetParametersResult from your callback',
        seen='something else',
        hint='end each branch of it with return SetParametersResult(successful=…)',
        cause='your callback returns no SetParametersResult',
    )
