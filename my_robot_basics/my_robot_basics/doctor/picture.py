"""The graph around a topic, service or action as a picture, with the broken edges marked."""

from typing import TYPE_CHECKING

from my_robot_basics.doctor.evidence import Diagnosis, Endpoint, Evidence, Kind
from my_robot_basics.doctor.report import summary
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# Okabe and Ito's palette, for colour-blind readers; a broken edge is also dashed and crossed
WELL, BROKEN, TOPIC = '#0072b2', '#d55e00', '#f0f0f0'
ROW = 0.9
LEFT, MIDDLE, RIGHT = 0.0, 1.0, 2.0


def describe(diagnosis: Diagnosis) -> str:
    """Return the picture's alternative text."""
    graph = (
        gettext_noop(f'graph of {diagnosis.evidence.name}') + f': {summary(diagnosis.evidence)}'
    )
    if not diagnosis.findings:
        return graph
    first = diagnosis.findings[0]
    names = sorted({end.node_name for end in first.broken})
    where = ', '.join(names) or gettext_noop(f'no {first.missing}')
    return f'{graph}; ' + gettext_noop(f'broken: {where} ({first.title})')


def draw(diagnosis: Diagnosis) -> bytes:
    """Return a PNG: publishers or clients on the left, subscriptions or servers on the right."""
    from matplotlib.figure import Figure  # takes a second

    evidence = diagnosis.evidence
    first = diagnosis.findings[0] if diagnosis.findings else None
    columns: dict[Kind, list[Endpoint | None]] = {}
    for kind in evidence.KINDS:
        there = evidence.ends(kind)
        away = [
            end for end in (first.broken if first else ()) if end.kind == kind and end not in there
        ]
        columns[kind] = [*there, *away]
        if first and first.missing == kind and not away:
            columns[kind].append(None)
    rows = max(1, *map(len, columns.values()))
    figure = Figure(figsize=(7.0, 1.2 + 0.8 * rows), dpi=80, layout='constrained')
    axes = figure.add_subplot()
    axes.set(xlim=(-0.5, 2.5), ylim=(-0.5 * ROW * rows - 0.2, 0.5 * ROW * rows + 0.2))
    axes.set_axis_off()
    rate = f': {evidence.rate_hz:.3g} Hz' if isinstance(evidence, Evidence) else ''
    axes.set_title(first.title if first else f'all is well{rate}')
    box(axes, MIDDLE, 0.0, evidence.name, style='round4', face=TOPIC)
    for x, (kind, ends) in zip((LEFT, RIGHT), columns.items(), strict=True):
        for row, end in enumerate(ends):
            y = ROW * ((len(ends) - 1) / 2 - row)
            is_broken = end is None or (first is not None and end in first.broken)
            way = [(x, y), (MIDDLE, 0.0)]
            start, stop = way if x == LEFT else reversed(way)
            arrow(axes, start, stop, is_broken=is_broken)
            box(axes, x, y, _label(end, kind, evidence.name), face='white')
    return png(figure)


def _label(end: Endpoint | None, kind: Kind, name: str) -> str:
    if end is None:
        return f'no {kind}'
    elsewhere = f'\n({end.name})' if end.name != name else ''
    return end.node_name + elsewhere


def box(axes: 'Axes', x: float, y: float, text: str, *, face: str, style: str = 'square') -> None:
    """Draw a name in a frame; callers give topics round corners and another colour than nodes."""
    axes.text(
        *(x, y, text),
        ha='center',
        va='center',
        fontsize=9,
        zorder=3,
        bbox={'boxstyle': f'{style},pad=0.5', 'facecolor': face, 'edgecolor': 'black'},
    )


def arrow(
    axes: 'Axes',
    start: tuple[float, float],
    stop: tuple[float, float],
    *,
    is_broken: bool = False,
    bend: float = 0.0,
) -> None:
    """Draw an arrow in the direction of the messages; a broken one is dashed and crossed.

    `bend` raises its middle.
    """
    colour = BROKEN if is_broken else WELL
    middle = (start[0] + stop[0]) / 2, (start[1] + stop[1]) / 2 + bend
    way = zip(start, middle, stop, strict=True)
    axes.plot(*way, color=colour, lw=2, ls='--' if is_broken else '-')
    if is_broken:
        axes.plot(*middle, 'X', color=colour, ms=14, zorder=4)
        return
    axes.annotate(
        '',
        xy=_towards(stop, middle),
        xytext=_towards(start, middle),
        arrowprops={'arrowstyle': '-|>', 'color': colour, 'lw': 2, 'mutation_scale': 18},
    )


def _towards(end: tuple[float, float], middle: tuple[float, float]) -> tuple[float, float]:
    return 0.9 * middle[0] + 0.1 * end[0], 0.9 * middle[1] + 0.1 * end[1]
