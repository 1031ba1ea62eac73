"""Refuse a type that is not an action's when an ActionClient or an ActionServer is created.

rclpy uses that type without a check, and crashes with a segmentation fault: the kernel would end
without an error message. For topics and services, rclpy itself checks the type.
"""

import functools
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient, ActionServer

from my_robot_basics.live.patches.patching import patch
from my_robot_basics.session.errors import WrongType

_POSITION = 1
"""The position of the type among the arguments, after the node."""


def expect_action_types() -> None:
    """Make both classes raise WrongType from now on instead of crashing."""
    for owner in (ActionClient, ActionServer):
        patch(owner, '__init__', _checking(owner.__init__, owner.__name__))


def _checking(init: Callable[..., None], maker: str) -> Callable[..., None]:
    @functools.wraps(init)
    def checking_init(self: Any, *args: Any, **kwargs: Any) -> None:
        __tracebackhide__ = True
        given = [*args[_POSITION:], *filter(None, [kwargs.get('action_type')])]
        if given and not hasattr(getattr(given[0], 'Impl', None), 'SendGoalService'):
            raise WrongType(
                f'{maker} expects the type of an action, such as MoveArm, and got '
                f'{_seen(given[0])}: write {maker}(self, MoveArm, …)'
            )
        init(self, *args, **kwargs)

    return checking_init


def _seen(given: object) -> str:
    """Describe what was given in place of an action's type."""
    if not (isinstance(given, type) and hasattr(type(given), '_TYPE_SUPPORT')):
        return f'{given!r:.80}'
    name = given.__name__.replace('_', '.', 1)  # the class of MoveArm.Goal is called MoveArm_Goal
    if hasattr(given, 'Request'):
        return f'{name}, the type of a service'
    return f'{name}, a part of a type' if '.' in name else f'{name}, the type of a message'
