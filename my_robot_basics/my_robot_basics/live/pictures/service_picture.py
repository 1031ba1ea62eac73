"""A sequence diagram of two clients and one server."""

from typing import TYPE_CHECKING

from my_robot_basics.doctor import picture
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.live.output import notebook

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, HEIGHT = 10.0, 7.0
LEFT, SERVER, RIGHT = 1.4, 5.0, 8.6
"""The x positions of the three nodes; time goes down."""
TOP, BOTTOM = 6.2, 0.3
WORK_WIDTH = 0.5
WORKS = '#e69f00'
REQUEST, RESPONSE = '-', '--'
"""Line styles: a response is dashed, as usual in sequence diagrams."""


def show_service() -> None:
    """Show how a server answers two clients: each gets the response to its own request."""
    text = gettext_noop(
        'two clients and one server, from top to bottom: left sends a request → right sends a '
        'request → the callback for left runs → the response goes to left alone → the callback '
        'for right runs → the response goes to right alone'
    )
    notebook.show_picture(draw(), text)


def draw() -> bytes:
    """Return the sequence diagram as a PNG, 400 pixels wide."""
    from matplotlib.figure import Figure  # takes a second

    figure = Figure(figsize=(4.0, 2.8), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, WIDTH), ylim=(0, HEIGHT))
    axes.set_axis_off()
    for x, name in (LEFT, 'client left'), (SERVER, 'server'), (RIGHT, 'client right'):
        axes.plot([x, x], [BOTTOM, TOP], color='0.7', lw=1, zorder=0)
        picture.box(axes, x, TOP, name, face='white')
    _work(axes, 4.9, 3.0)
    _work(axes, 2.7, 0.8)
    _arrow(axes, LEFT, SERVER, 4.9, 'request', REQUEST)
    _arrow(axes, RIGHT, SERVER, 4.4, 'request', REQUEST)
    _arrow(axes, SERVER, LEFT, 3.0, 'response', RESPONSE)
    _arrow(axes, SERVER, RIGHT, 0.8, 'response', RESPONSE)
    return png(figure)


def _work(axes: 'Axes', begin: float, end: float) -> None:
    """Draw a bar for the time in which the server's callback runs."""
    left = SERVER - WORK_WIDTH / 2
    axes.bar(left, begin - end, WORK_WIDTH, end, align='edge', color=WORKS, edgecolor='black')


def _arrow(axes: 'Axes', start: float, stop: float, y: float, label: str, line: str) -> None:
    towards = 1 if stop > start else -1
    begins = start + towards * WORK_WIDTH / 2 * (start == SERVER)
    ends = stop - towards * WORK_WIDTH / 2 * (stop == SERVER)
    style = {'arrowstyle': '-|>', 'color': picture.WELL, 'lw': 2, 'mutation_scale': 15}
    style |= {'linestyle': line, 'shrinkA': 0, 'shrinkB': 0}
    axes.annotate('', xy=(ends, y), xytext=(begins, y), arrowprops=style)
    axes.text((begins + ends) / 2, y + 0.1, label, ha='center', va='bottom', fontsize=10)
