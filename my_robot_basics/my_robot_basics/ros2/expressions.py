"""Python expressions over a message, as `--filter` takes them."""

from collections.abc import Callable
from typing import Any

from my_robot_basics.ros2.errors import CommandError


def message_filter(expression: str | None) -> Callable[[Any], bool]:
    """A test for messages, called `m` in the expression; without an expression all pass it.

    Raises CommandError for what is no expression, and the test does for one that fails.
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
