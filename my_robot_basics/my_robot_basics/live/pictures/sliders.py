"""Two sliders that move a picture of the arm."""

import ipywidgets
from IPython.display import display

from my_robot_basics.drawing.arm import ArmPicture, describe
from my_robot_basics.live.output import notebook
from my_robot_basics.two_link_kinematics import L1, L2

WITHOUT_WIDGETS = 'Run this cell: two sliders, for θ1 and θ2, appear here and move the arm.'
TARGET_WITHOUT_WIDGETS = (
    'Run this cell: two sliders, for x and y, appear here and publish the target point.'
)
"""Texts in place of the sliders if no kernel runs, as on GitHub."""


def move_arm(
    theta1_deg: float = 30.0, theta2_deg: float = 45.0, *, l1: float = L1, l2: float = L2
) -> None:
    """Show the arm and two sliders that set its angles; link lengths are in metres.

    The arm starts at these angles, in degrees between -180 and 180. Outside a notebook kernel
    there are no sliders: the pose is printed as text.
    """
    ArmSliders(theta1_deg, theta2_deg, l1=l1, l2=l2).show()


class ArmSliders:
    """Two sliders, `theta1` and `theta2`, and one picture that is redrawn at each change."""

    def __init__(self, theta1_deg: float, theta2_deg: float, *, l1: float, l2: float) -> None:
        """Make the sliders and the axes of the picture; nothing shows before `show`."""
        self.theta1 = _slider('θ1 in °', theta1_deg)
        self.theta2 = _slider('θ2 in °', theta2_deg)
        self._l1, self._l2 = l1, l2
        self._picture = ArmPicture(l1=l1, l2=l2)
        self._display = notebook.Display()

    def show(self) -> None:
        """Show sliders and picture with the cell that runs now."""
        if notebook.in_kernel():
            show_widgets(self.theta1, self.theta2, without=WITHOUT_WIDGETS)
        self._display.show(self._bundle())
        for slider in (self.theta1, self.theta2):
            slider.observe(self._moved, names='value')

    def _moved(self, change: object) -> None:
        # at once: the browser sends the next position only after this one is handled
        self._display.update(self._bundle())

    def _bundle(self) -> notebook.Bundle:
        pose_deg = self.theta1.value, self.theta2.value
        self._picture.move(*pose_deg)
        text = describe(*pose_deg, l1=self._l1, l2=self._l2)
        return {'image/png': self._picture.png(), 'text/plain': text}


def show_widgets(*widgets: ipywidgets.Widget, without: str) -> None:
    """Show widgets below each other, and the text `without` if no kernel runs."""
    box = ipywidgets.VBox(widgets)
    display(box._repr_mimebundle_() | {'text/plain': without}, raw=True)


def _slider(description: str, value_deg: float) -> ipywidgets.FloatSlider:
    return ipywidgets.FloatSlider(
        value=value_deg,
        min=-180.0,
        max=180.0,
        step=1.0,
        description=description,
        readout_format='.0f',
        layout={'width': '30em'},
    )
