"""A picture of many poses, each marked by the IK branch that it belongs to."""

from collections.abc import Iterable

import numpy as np

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.kinematics_subscriber import same_pose
from my_robot_basics.live.output import notebook
from my_robot_basics.two_link_kinematics import L1, L2, forward_kinematics, inverse_kinematics

STYLES = {'elbow_up': ('^', '#0072b2'), 'elbow_down': ('v', '#d55e00')}
"""Markers and colours; Okabe and Ito's palette, for colour-blind readers."""


def branch_of(theta1_deg: float, theta2_deg: float, *, l1: float = L1, l2: float = L2) -> str:
    """Return the IK branch that contains a pose; angles in degrees, lengths in metres.

    A stretched or folded arm is in both branches: then it is elbow_up. Raises ValueError if the
    pose is in neither branch.
    """
    x, y = forward_kinematics(theta1_deg, theta2_deg, l1, l2)
    for branch, solution in inverse_kinematics(x, y, l1, l2).items():
        if same_pose((theta1_deg, theta2_deg), solution):
            return branch
    raise ValueError(f'IK finds θ1 = {theta1_deg}°, θ2 = {theta2_deg}° in neither branch')


def show_branches(
    poses_deg: Iterable[tuple[float, float]], *, l1: float = L1, l2: float = L2
) -> None:
    """Show poses (θ1, θ2) in degrees, marked by branch, and their end effectors' positions.

    Link lengths are in metres.
    """
    from matplotlib.figure import Figure  # takes a second

    poses: dict[str, list[tuple[float, float]]] = {branch: [] for branch in STYLES}
    for pose in poses_deg:
        poses[branch_of(*pose, l1=l1, l2=l2)].append(pose)
    figure = Figure(figsize=(7.4, 3.9), dpi=80, layout='constrained')
    angles, places = figure.subplots(1, 2)
    for branch, members in poses.items():
        marker, colour = STYLES[branch]
        style = {'marker': marker, 'ls': '', 'color': colour, 'ms': 5, 'alpha': 0.8}
        theta1_deg, theta2_deg = np.transpose(members) if members else ([], [])
        label = f'{branch} ({len(members)})'
        angles.plot(theta1_deg, theta2_deg, label=label, **style)
        places.plot(*forward_kinematics(theta1_deg, theta2_deg, l1, l2), **style)
    angles.axhline(0.0, color='black', lw=0.8)
    angles.set(title='pose', xlabel='θ1 (degrees)', ylabel='θ2 (degrees)')
    places.set(
        title='end effector',
        xlabel='x in base_link (m)',
        ylabel='y in base_link (m)',
        aspect='equal',
    )
    figure.legend(loc='outside lower center', ncols=2, frameon=False)
    counts = ' and '.join(
        gettext_noop(f'{len(members)} in {branch}') for branch, members in poses.items()
    )
    text = gettext_noop('poses by branch') + f': {counts}; '
    text += gettext_noop('elbow_up has θ2 below 0, elbow_down above')
    notebook.show_picture(png(figure), text)
