"""Python expressions about a message, for `--filter`."""

from collections.abc import Callable
from typing import Any

from my_robot_basics.ros2.errors import CommandError


def message_filter(expression: str | None) -> Callable[[Any], bool]:
    """Return a test for messages, which the expression calls `m`; without one, all pass.

    Raises CommandError for an invalid expression; the test raises it if the expression fails.
    """
    if expression is None:
        return lambda message: True
    try:
        code = compile(expression, '--filter', 'eval')
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise CommandError(f'--filter: not Python: {expression!r} ({error})') from None

    def passes(message: Any) -> bool:
        try:
            return bool(eval(code, {'m': message}))
        except Exception as error:
            problem = f'{type(error).__name__}: {error}'
            raise CommandError(
                f'--filter: {expression!r} failed on a message: {problem}'
            ) from None

    return passes
