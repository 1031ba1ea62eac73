"""A picture of the current ROS graph: nodes, topics, and the direction of the messages."""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from graphlib import TopologicalSorter
from statistics import fmean
from typing import NamedTuple

from my_robot_basics.doctor import picture
from my_robot_basics.doctor.evidence import Endpoint
from my_robot_basics.doctor.looking import endpoints_of
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.live.output import notebook

COLUMN_INCHES, ROW_INCHES = 2.5, 0.75
ASIDE = 0.12
"""Distance, in rows, of two opposite arrows from the line between their boxes."""
BEND = 0.5
"""How far an arrow is bent, in rows, to avoid the boxes between its ends."""


class Box(NamedTuple):
    """A node, by its full name; or a topic with one message type.

    A topic name with two types is two boxes: no message gets from one type to the other.
    """

    name: str
    type_name: str = ''

    def __str__(self) -> str:
        """Return the text in the box."""
        return f'{self.name}\n{self.type_name}' if self.type_name else self.name


Arrows = dict[Box, tuple[Box, ...]]
"""For each box, the boxes to which its messages go."""


def show_graph(title: str = '') -> None:
    """Show which nodes publish and subscribe on each topic of this lesson's ROS domain now.

    Nodes whose names start with `_`, and ROS's own topics, are left out. The arrows show the
    direction of the messages, mostly from left to right.
    """
    with Watcher() as watcher:
        nodes = graphs.take_snapshot(watcher).nodes()
        arrows = arrows_of(nodes, endpoints_of(watcher.node))
    text = describe(arrows)
    notebook.show_picture(draw(arrows, title=title), text)


def arrows_of(nodes: Iterable[str], endpoints: Iterable[Endpoint]) -> Arrows:
    """Return the graph of nodes (full names, also those without endpoints) and endpoints."""
    found: dict[Box, set[Box]] = {Box(name): set() for name in nodes}
    for end in endpoints:
        node, topic = Box(end.node_name), Box(end.name, end.type_name)
        start, stop = (node, topic) if end.kind == 'publisher' else (topic, node)
        found.setdefault(start, set()).add(stop)
        found.setdefault(stop, set())
    return {box: tuple(sorted(found[box])) for box in sorted(found)}


def describe(arrows: Arrows) -> str:
    """Return the picture's alternative text."""
    senders: dict[Box, list[str]] = defaultdict(list)
    for box, others in arrows.items():
        for other in others:
            senders[other].append(box.name)
    said = [
        f'{topic.name} ({topic.type_name}): '
        + gettext_noop(
            f'{_join_names(senders[topic])} → {_join_names(box.name for box in arrows[topic])}'
        )
        for topic in arrows
        if topic.type_name
    ]
    alone = [box.name for box in arrows if not (box.type_name or arrows[box] or senders[box])]
    if alone:
        said.append(gettext_noop(f'on no topic: {_join_names(alone)}'))
    return gettext_noop('graph') + ': ' + ('; '.join(said) or gettext_noop('no node is running'))


def draw(arrows: Arrows, *, title: str = '') -> bytes:
    """Return the graph as a PNG."""
    from matplotlib.figure import Figure  # takes a second

    places = _places(arrows)
    columns = 1 + max((x for x, _ in places.values()), default=0)
    heights = [y for _, y in places.values()] or [0.0]
    bottom, top = min(heights) - 0.6, max(heights) + 0.6
    size = (COLUMN_INCHES * columns, ROW_INCHES * (top - bottom) + 0.3 * bool(title))
    figure = Figure(figsize=size, dpi=100, layout='constrained')
    axes = figure.add_subplot()
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(bottom, top), title=title)
    axes.set_axis_off()
    if not places:
        axes.text(0, 0, 'no node is running', ha='center', va='center')
    for box, (x, y) in places.items():
        style, face = ('round4', picture.TOPIC) if box.type_name else ('square', 'white')
        picture.box(axes, x, y, str(box), style=style, face=face)
        for other in arrows[box]:
            to_x, to_y = places[other]
            aside = ASIDE * (1 if to_x > x else -1) if box in arrows[other] else 0.0
            bend = BEND if abs(to_x - x) > 1 else 0.0
            picture.arrow(axes, (x, y + aside), (to_x, to_y + aside), bend=bend)
    return png(figure)


def _places(arrows: Arrows) -> dict[Box, tuple[int, float]]:
    """Return column and height of each box: nodes in even columns, topics in odd ones.

    A box is about as high as its senders; one without senders, as its receivers; and one without
    either is below all others.
    """
    columns = _columns(arrows)
    senders = {box: [other for other in arrows if box in arrows[other]] for box in arrows}
    heights: dict[Box, float] = {}

    def put(boxes: Iterable[Box], neighbours: Mapping[Box, Iterable[Box]]) -> None:
        wanted = {
            box: fmean([heights[other] for other in neighbours[box] if other in heights] or [0.0])
            for box in boxes
        }
        heights.update(_spread_heights(wanted))

    linked = [box for box in arrows if arrows[box] or senders[box]]
    in_columns = [
        [box for box in linked if columns[box] == column] for column in sorted({*columns.values()})
    ]
    for boxes in in_columns:
        put(boxes, senders)
    for boxes in in_columns:
        put(boxes, {box: [box] if senders[box] else arrows[box] for box in boxes})
    lowest = min(heights.values(), default=1.0)
    alone = [box for box in arrows if box not in heights]
    heights.update({box: lowest - row for row, box in enumerate(alone, start=1)})
    return {box: (columns[box], heights[box]) for box in arrows}


def _spread_heights(wanted: dict[Box, float]) -> dict[Box, float]:
    """Return heights close to those wanted at which boxes of one column are a row apart."""
    heights: dict[Box, float] = {}
    for box in sorted(wanted, key=lambda box: (-wanted[box], box)):
        heights[box] = min([wanted[box], *(height - 1 for height in heights.values())])
    shift = fmean(wanted[box] - heights[box] for box in wanted) if wanted else 0.0
    return {box: height + shift for box, height in heights.items()}


def _columns(arrows: Arrows) -> dict[Box, int]:
    """Return a column for each box, to the right of its senders; loops are broken up."""
    senders = _without_loops(arrows)
    columns: dict[Box, int] = {}
    for box in TopologicalSorter(senders).static_order():
        first = int(bool(box.type_name))
        columns[box] = max([first, *(columns[sender] + 1 for sender in senders[box])])
    for box, others in arrows.items():
        if others and not senders[box]:  # move it next to its receivers
            columns[box] = max(columns[box], min(columns[other] for other in others) - 1)
    return columns


def _without_loops(arrows: Arrows) -> dict[Box, set[Box]]:
    """Return the senders of each box, without the arrows that close a loop."""
    senders: dict[Box, set[Box]] = {box: set() for box in arrows}
    done: set[Box] = set()

    def visit(box: Box, way: tuple[Box, ...]) -> None:
        for other in arrows[box]:
            if other not in way:
                senders[other].add(box)
                if other not in done:
                    visit(other, (*way, other))
        done.add(box)

    reached = {other for others in arrows.values() for other in others}
    for box in sorted(arrows, key=lambda box: (box in reached, bool(box.type_name), box)):
        if box not in done:
            visit(box, (box,))
    return senders


def _join_names(names: Iterable[str]) -> str:
    return ' and '.join(names) or gettext_noop('nobody')
