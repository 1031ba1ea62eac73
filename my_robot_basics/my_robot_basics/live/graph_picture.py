"""A picture of the ROS graph as it is now: nodes, topics, and the way of the messages."""

from collections import defaultdict
from collections.abc import Iterable
from graphlib import TopologicalSorter
from typing import NamedTuple

from my_robot_basics.checks import graphs
from my_robot_basics.checks.watcher import Watcher
from my_robot_basics.doctor import picture
from my_robot_basics.doctor.evidence import Endpoint
from my_robot_basics.doctor.looking import endpoints_of
from my_robot_basics.live import notebook

COLUMN_INCHES, ROW_INCHES = 2.5, 0.75
ASIDE = 0.12
"""How far two arrows between the same two boxes stand from the line between them, in rows."""


class Box(NamedTuple):
    """A node, by its full name; or a topic with one message type.

    Where a topic's name is used with two types, nothing crosses between them: it is two boxes.
    """

    name: str
    type_name: str = ''

    def __str__(self) -> str:
        """What stands in the box."""
        return f'{self.name}\n{self.type_name}' if self.type_name else self.name


Arrows = dict[Box, tuple[Box, ...]]
"""For each box, the boxes to which its messages go."""


def show_graph(title: str = '') -> None:
    """Show who publishes and who subscribes, on every topic of this lesson's ROS domain, now.

    Left out are nodes whose names start with `_`, and ROS's own topics. Messages go along the
    arrows, mostly from left to right.
    """
    with Watcher() as watcher:
        nodes = graphs.take(watcher).nodes()
        arrows = arrows_of(nodes, endpoints_of(watcher.node))
    text = describe(arrows)
    display = notebook.Display({'image/png': {'alt': text}})
    display.show({'image/png': draw(arrows, title=title), 'text/plain': text})


def arrows_of(nodes: Iterable[str], endpoints: Iterable[Endpoint]) -> Arrows:
    """Make the graph of nodes (full names, those without endpoints too) and their endpoints."""
    found: dict[Box, set[Box]] = {Box(name): set() for name in nodes}
    for end in endpoints:
        node, topic = Box(end.node_name), Box(end.topic_name, end.type_name)
        start, stop = (node, topic) if end.kind == 'publisher' else (topic, node)
        found.setdefault(start, set()).add(stop)
        found.setdefault(stop, set())
    return {box: tuple(sorted(found[box])) for box in sorted(found)}


def describe(arrows: Arrows) -> str:
    """The picture in words, for those who can't see it."""
    senders: dict[Box, list[str]] = defaultdict(list)
    for box, others in arrows.items():
        for other in others:
            senders[other].append(box.name)
    said = [
        f'{topic.name} ({topic.type_name}): {_listed(senders[topic])} → '
        f'{_listed(listener.name for listener in arrows[topic])}'
        for topic in arrows
        if topic.type_name
    ]
    alone = [box.name for box in arrows if not (box.type_name or arrows[box] or senders[box])]
    if alone:
        said.append(f'on no topic: {_listed(alone)}')
    return 'graph: ' + ('; '.join(said) or 'no node is running')


def draw(arrows: Arrows, *, title: str = '') -> bytes:
    """The graph as a PNG."""
    from matplotlib.figure import Figure  # takes a second

    places = _places(arrows)
    columns = 1 + max((x for x, _ in places.values()), default=0)
    half = 0.5 + max((y for _, y in places.values()), default=0)
    size = (COLUMN_INCHES * columns, ROW_INCHES * 2 * half + 0.3 * bool(title))
    figure = Figure(figsize=size, dpi=80, layout='constrained')
    axes = figure.add_subplot()
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(-half, half), title=title)
    axes.set_axis_off()
    if not places:
        axes.text(0, 0, 'no node is running', ha='center', va='center')
    for box, (x, y) in places.items():
        style, face = ('round4', picture.TOPIC) if box.type_name else ('square', 'white')
        picture.box(axes, x, y, str(box), style=style, face=face)
        for other in arrows[box]:
            goes_back = other in arrows and box in arrows[other]
            aside = ASIDE * (1 if places[other][0] > x else -1) if goes_back else 0.0
            picture.arrow(axes, (x, y + aside), (places[other][0], places[other][1] + aside))
    return picture.png(figure)


def _places(arrows: Arrows) -> dict[Box, tuple[int, float]]:
    """Column and height of each box: nodes in even columns, topics in odd ones."""
    columns: dict[int, list[Box]] = defaultdict(list)
    for box, column in _columns(arrows).items():
        columns[column].append(box)
    places: dict[Box, tuple[int, float]] = {}
    for column, boxes in sorted(columns.items()):
        heights = {
            box: [places[other][1] for other in places if box in arrows[other]] for box in boxes
        }

        def order(box: Box, heights: dict = heights) -> tuple[bool, float, Box]:
            is_alone = not (heights[box] or arrows[box])
            return is_alone, -sum(heights[box]) / max(1, len(heights[box])), box

        for row, box in enumerate(sorted(boxes, key=order)):
            places[box] = column, (len(boxes) - 1) / 2 - row
    return places


def _columns(arrows: Arrows) -> dict[Box, int]:
    """Each box stands right of those whose messages it gets; loops have a way back."""
    senders = _without_loops(arrows)
    columns: dict[Box, int] = {}
    for box in TopologicalSorter(senders).static_order():
        first = int(bool(box.type_name))
        columns[box] = max([first, *(columns[sender] + 1 for sender in senders[box])])
    for box, others in arrows.items():
        if others and not senders[box]:  # close to where its messages go
            columns[box] = max(columns[box], min(columns[other] for other in others) - 1)
    return columns


def _without_loops(arrows: Arrows) -> dict[Box, set[Box]]:
    """For each box those that send to it, without the arrows that close a loop."""
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


def _listed(names: Iterable[str]) -> str:
    return ' and '.join(names) or 'nobody'
