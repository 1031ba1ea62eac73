"""A picture of QoS compatibility: a subscription may not request more than is offered."""

from itertools import product
from typing import TYPE_CHECKING

from my_robot_basics.doctor import picture
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.live.output import notebook

if TYPE_CHECKING:
    from matplotlib.axes import Axes


POLICIES = {
    'reliability': ('RELIABLE', 'BEST_EFFORT'),
    'durability': ('TRANSIENT_LOCAL', 'VOLATILE'),
}
"""The values of each policy, the stronger one first."""
OFFERED, REQUESTED = 0.0, 1.0
GAP = 0.07
"""The distance between the end of a line and the name beside it."""
CROSS = 0.25
"""Where an incompatible pair's line is crossed: not in the middle, where two lines meet."""


def show_offers() -> None:
    """Show which offered and requested values of reliability and durability are compatible."""
    said = [
        gettext_noop(f'{offered} → {requested} yes')
        if matches(values, offered, requested)
        else gettext_noop(f'{offered} → {requested} no')
        for values in POLICIES.values()
        for offered, requested in product(values, repeat=2)
    ]
    text = gettext_noop('offered → requested, does it match') + ': ' + ', '.join(said)
    notebook.show_picture(draw(), text)


def matches(values: tuple[str, str], offered: str, requested: str) -> bool:
    """Whether the pair is compatible; `values` has the stronger value first."""
    return values.index(offered) <= values.index(requested)


def draw() -> bytes:
    """Return a PNG, 400 pixels wide: a panel for each policy, arrows for compatible pairs."""
    from matplotlib.figure import Figure  # takes a second

    figure = Figure(figsize=(4.0, 3.4), dpi=100, layout='constrained')
    panels = figure.subplots(len(POLICIES), 1)
    for axes, (policy, values) in zip(panels, POLICIES.items(), strict=True):
        axes.set(xlim=(-1.6, 2.6), ylim=(1.5, -0.5))
        axes.set_axis_off()
        axes.set_title(f'{policy}: offered → requested', fontsize=11)
        for offered, requested in product(values, repeat=2):
            _line(axes, values.index(offered), values.index(requested))
        for y, value in enumerate(values):
            _name(axes, OFFERED, y, value, side='right')
            _name(axes, REQUESTED, y, value, side='left')
    return png(figure)


def _name(axes: 'Axes', x: float, y: float, value: str, *, side: str) -> None:
    frame = {'boxstyle': 'square,pad=0.4', 'facecolor': 'white', 'edgecolor': 'black'}
    axes.text(x, y, value, ha=side, va='center', fontsize=10, bbox=frame)


def _line(axes: 'Axes', offered: int, requested: int) -> None:
    """Draw an arrow for a compatible pair; a dashed, crossed line for an incompatible one."""
    start, stop = (OFFERED + GAP, offered), (REQUESTED - GAP, requested)
    if offered <= requested:
        style = {'arrowstyle': '-|>', 'color': picture.WELL, 'lw': 2, 'mutation_scale': 16}
        axes.annotate('', xy=stop, xytext=start, arrowprops={**style, 'shrinkA': 0, 'shrinkB': 0})
        return
    way = zip(start, stop, strict=True)
    axes.plot(*way, color=picture.BROKEN, lw=2, ls='--')
    at = [(1 - CROSS) * a + CROSS * b for a, b in zip(start, stop, strict=True)]
    axes.plot(*at, 'X', color=picture.BROKEN, ms=12, zorder=4)
