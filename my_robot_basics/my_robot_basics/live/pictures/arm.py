"""Pictures of the two-link arm in a notebook."""

import numpy as np
from numpy.typing import ArrayLike

from my_robot_basics.drawing.arm import ArmPicture, describe
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.live.output import notebook
from my_robot_basics.two_link_kinematics import L1, L2


def show_arm(
    theta1_deg: float,
    theta2_deg: float,
    *,
    l1: float = L1,
    l2: float = L2,
    title: str = '',
    other: tuple[float, float] | None = None,
    dots: tuple[ArrayLike, ArrayLike] | None = None,
) -> None:
    """Show a picture of the arm in one pose: angles in degrees, link lengths in metres.

    A second pose, `other`, is drawn dashed; `dots` are points, (all x, all y) in metres.
    Raises ValueError for angles or lengths that are not finite numbers.
    """
    text = describe(theta1_deg, theta2_deg, l1=l1, l2=l2)
    picture = ArmPicture(l1=l1, l2=l2)
    if dots is not None:
        picture.dots(*dots)
        text += '; ' + gettext_noop(f'{np.size(dots[0])} dots')
    if other is not None:
        picture.dashed(*other)
        text += '; ' + gettext_noop(f'dashed: θ1 = {other[0]:.1f}°, θ2 = {other[1]:.1f}°')
    picture.move(theta1_deg, theta2_deg, title=title)
    notebook.show_picture(picture.png(), text)
