"""Refuse what is no type of an action, where an ActionClient or an ActionServer is made.

rclpy looks into that type without a check, and crashes with a segmentation fault: the kernel would
be gone, without a word on why. Topics and services have such a check in rclpy itself.
"""

import functools
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient, ActionServer

from my_robot_basics.live.patching import patch
from my_robot_basics.session.errors import WrongType

_POSITION = 1
"""Where the type stands among the arguments, behind the node."""


def expect_action_types() -> None:
    """Let both raise WrongType from now on, in place of a crash."""
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
    """What was given in place of the type of an action."""
    if not (isinstance(given, type) and hasattr(type(given), '_TYPE_SUPPORT')):
        return f'{given!r:.80}'
    name = given.__name__.replace('_', '.', 1)  # the class of MoveArm.Goal is called MoveArm_Goal
    if hasattr(given, 'Request'):
        return f'{name}, the type of a service'
    return f'{name}, a part of a type' if '.' in name else f'{name}, the type of a message'
