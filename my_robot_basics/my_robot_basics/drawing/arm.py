"""Pictures of the two-link arm: metres, equal aspect, the reachable ring, angles in degrees."""

import io
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.labels import PictureLabel, place, points_along
from my_robot_basics.two_link_kinematics import L1, L2, forward_kinematics

# Okabe and Ito's palette: colour-blind readers can distinguish these colours, too
LINK1, LINK2, EFFECTOR, ANGLE, RING = '#0072b2', '#d55e00', '#009e73', '#000000', '#56b4e9'
DASHED = '#666666'
BEHIND = 1.5
"""zorder of what the arm is drawn over: above the ring, below other lines."""


def describe(theta1_deg: float, theta2_deg: float, *, l1: float = L1, l2: float = L2) -> str:
    """Return the pose and the end effector's position, in words."""
    x, y = forward_kinematics(theta1_deg, theta2_deg, l1, l2)
    return gettext_noop(
        f'two-link arm at θ1 = {theta1_deg:.1f}°, θ2 = {theta2_deg:.1f}°: '
        f'end effector at x = {x:.3f} m, y = {y:.3f} m'
    )


class ArmPicture:
    """One figure of the arm, drawn again for each pose."""

    def __init__(self, *, l1: float = L1, l2: float = L2) -> None:
        """Draw the axes and the reachable ring for links of these lengths in metres."""
        # importing matplotlib takes a second: do it only when a picture is drawn
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
        from matplotlib.patches import Wedge

        self._l1, self._l2 = l1, l2
        self._figure = Figure(figsize=(4.6, 5.1), dpi=80)
        # no pyplot: a picture may be drawn in any thread
        self._canvas = FigureCanvasAgg(self._figure)
        # a fixed layout: computing it for each drawing costs more than the drawing, and it jumps
        self._axes = axes = self._figure.add_axes((0.15, 0.15, 0.81, 0.73))
        reach = l1 + l2
        axes.set(
            xlim=(-1.1 * reach, 1.1 * reach),
            ylim=(-1.1 * reach, 1.1 * reach),
            aspect='equal',
            xlabel='x in base_link (m)',
            ylabel='y in base_link (m)',
        )
        axes.apply_aspect()  # else labels measured before the first drawing use another scale
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        frame = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
        self._frame = points_along(frame)
        axes.grid(color='0.9')
        axes.set_axisbelow(True)
        ring = Wedge(
            (0, 0), reach, 0, 360, width=reach - abs(l1 - l2), color=RING, alpha=0.2, lw=0
        )
        ring.set_label('reachable')
        axes.add_patch(ring)
        style: dict[str, Any] = {
            'solid_capstyle': 'round',
            'marker': 'o',
            'markerfacecolor': 'white',
        }
        (self._link1,) = axes.plot([], [], color=LINK1, lw=6, ms=9, label='link 1', **style)
        (self._link2,) = axes.plot([], [], color=LINK2, lw=4, ms=7, label='link 2', **style)
        (self._effector,) = axes.plot([], [], 'D', color=EFFECTOR, ms=9, label='end effector')
        style = {'color': DASHED, 'lw': 2, 'ms': 6, 'markerfacecolor': 'white'}
        (self._dashed,) = axes.plot([], [], '--o', zorder=BEHIND, **style)
        (self._target,) = axes.plot([], [], 'x', color=ANGLE, ms=13, mew=2)
        self._angles: list = []
        self._figure.legend(loc='lower center', ncols=4, fontsize=8, frameon=False)

    def move(self, theta1_deg: float, theta2_deg: float, *, title: str = '') -> None:
        """Show the arm in a pose; angles in degrees."""
        elbow = self._l1 * _direction(theta1_deg)
        x, y = forward_kinematics(theta1_deg, theta2_deg, self._l1, self._l2)
        self._link1.set_data([0, elbow[0]], [0, elbow[1]])
        self._link2.set_data([elbow[0], x], [elbow[1], y])
        self._effector.set_data([x], [y])
        while self._angles:
            self._angles.pop().remove()
        first = self._angle('θ1', theta1_deg, at=np.zeros(2), start_deg=0.0)
        second = self._angle('θ2', theta2_deg, at=elbow, start_deg=theta1_deg)
        lines = self._link1, self._link2, self._dashed, self._target
        avoid = np.concatenate([self._frame, *(points_along(line.get_xydata()) for line in lines)])
        avoid = np.concatenate([avoid, place(first, avoid=avoid)])
        place(second, avoid=avoid)
        pose = f'θ1 = {theta1_deg:.1f}°, θ2 = {theta2_deg:.1f}°  →  ({x:.3f}, {y:.3f}) m'
        self.title('\n'.join(filter(None, [title, pose])))

    def dashed(self, theta1_deg: float, theta2_deg: float) -> None:
        """Show a second, dashed arm in a pose until the next call; angles in degrees."""
        elbow = self._l1 * _direction(theta1_deg)
        tip = forward_kinematics(theta1_deg, theta2_deg, self._l1, self._l2)
        self._dashed.set_data(*zip((0, 0), elbow, tip, strict=True))

    def target(self, x: float, y: float) -> None:
        """Mark the point that the arm is to reach, in metres."""
        self._target.set_data([x], [y])

    def dots(self, x: ArrayLike, y: ArrayLike) -> None:
        """Add points, in metres."""
        self._axes.plot(x, y, ',', color=EFFECTOR, zorder=BEHIND)

    def title(self, text: str) -> None:
        """Set the title above the picture."""
        self._axes.set_title(text, fontsize=10)

    def png(self) -> bytes:
        """Return the picture as a PNG."""
        buffer = io.BytesIO()
        self._figure.savefig(buffer, format='png', pil_kwargs={'compress_level': 1})
        return buffer.getvalue()

    def _angle(
        self, name: str, angle_deg: float, *, at: np.ndarray, start_deg: float
    ) -> PictureLabel:
        """Draw an arc that begins at the direction `start_deg`, its zero line, and a label.

        The caller still has to place the label.
        """
        from matplotlib.patches import Arc
        from matplotlib.patheffects import withStroke

        shown_deg = (angle_deg + 180) % 360 - 180  # more than a turn looks the same
        size = 0.3 * (self._l1 + self._l2)
        first, last = sorted((start_deg, start_deg + shown_deg))
        point = float(at[0]), float(at[1])
        arc = Arc(point, size, size, theta1=first, theta2=last, color=ANGLE, lw=1.2)
        zero_line = np.array([at, at + 0.8 * size * _direction(start_deg)]).T
        zero = self._axes.plot(*zero_line, color=ANGLE, lw=0.8, ls=':')
        words = self._axes.annotate(
            f'{name} = {angle_deg:.1f}°',
            point,
            fontsize=9,
            va='bottom',
            path_effects=[withStroke(linewidth=3, foreground='white')],
        )
        self._angles += [self._axes.add_patch(arc), *zero, words]
        return PictureLabel(
            words, at, distance=0.62 * size, direction_deg=start_deg + shown_deg / 2
        )


def _direction(angle_deg: float) -> np.ndarray:
    """Return the unit vector of that direction."""
    return np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
