"""A picture of a message's path: publisher, two queues, executor, callback."""

from typing import TYPE_CHECKING

from my_robot_basics.doctor import picture
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.live.output import notebook

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WAITS, FREE = '#56b4e9', 'white'
"""Colours of a place in a queue with a message, and without one."""
PLACES = 3
WIDTH, HEIGHT = 10.0, 7.0
TOP, BOTTOM = 5.4, 1.0
"""Heights of the publisher's row and of the subscription's row."""
ROUND = 'round4'


def show_queues() -> None:
    """Show where a message waits between `publish` and the callback: in two queues."""
    text = gettext_noop(
        "path of a message: publisher → the publisher's queue → topic → the subscription's queue "
        '→ the executor takes it → callback'
    )
    notebook.show_picture(draw(), text)


def draw() -> bytes:
    """Return a message's path as a PNG, 400 pixels wide: publisher above, subscription below."""
    from matplotlib.figure import Figure  # takes a second

    figure = Figure(figsize=(4.0, 2.8), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, WIDTH), ylim=(0, HEIGHT))
    axes.set_axis_off()
    picture.box(axes, 1.7, TOP, 'publisher', face='white')
    _queue(axes, 8.0, TOP, "publisher's queue", waiting=1)
    _queue(axes, 8.0, BOTTOM, "subscription's queue", waiting=2)
    picture.box(axes, 4.9, BOTTOM, 'executor', face='white')
    picture.box(axes, 1.7, BOTTOM, 'callback', face='white')
    _arrow(axes, (3.0, TOP), (6.5, TOP), 'publish')
    _arrow(axes, (8.0, TOP - 0.5), (8.0, BOTTOM + 1.2))
    picture.box(axes, 8.0, 3.7, '/topic', style=ROUND, face=picture.TOPIC)
    _arrow(axes, (6.5, BOTTOM), (6.0, BOTTOM))
    _arrow(axes, (3.8, BOTTOM), (2.85, BOTTOM), 'calls')
    return png(figure)


def _queue(axes: 'Axes', x: float, y: float, title: str, *, waiting: int) -> None:
    """Draw a queue around (x, y) with `waiting` messages."""
    for place in range(PLACES):
        left = x + 0.9 * (place - PLACES / 2)
        face = WAITS if place < waiting else FREE
        axes.bar(
            left, 0.9, width=0.9, bottom=y - 0.45, align='edge', color=face, edgecolor='black'
        )
    axes.text(x, y + 0.65, title, ha='center', va='bottom', fontsize=10)


def _arrow(
    axes: 'Axes', start: tuple[float, float], stop: tuple[float, float], label: str = ''
) -> None:
    style = {'arrowstyle': '-|>', 'color': picture.WELL, 'lw': 2, 'mutation_scale': 15}
    axes.annotate('', xy=stop, xytext=start, arrowprops={**style, 'shrinkA': 0, 'shrinkB': 0})
    middle = (start[0] + stop[0]) / 2
    axes.text(middle, start[1] + 0.25, label, ha='center', va='bottom', fontsize=10)
