"""Pictures for the feedback, as PNG bytes."""

import math
from collections.abc import Sequence

from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.drawing.figures import png

SHOWN_PERIODS = 25
# from Okabe and Ito's palette, which colour-blind readers can tell apart, too
SEEN, EXPECTED = '#d55e00', '#0072b2'


def plot_arrivals(recording: RecordedMessages, *, hz: float | None = None) -> bytes:
    """Plot when the messages of a recording arrived; with `hz`, also when they should have."""
    from matplotlib.figure import Figure  # slow to import (1 s), and rarely needed

    until = min(recording.seconds, SHOWN_PERIODS / (hz or recording.rate_hz or 1.0))
    seen = [s.time_sec for s in recording.messages if s.time_sec <= until]
    rows = [('seen', seen, SEEN)]
    if hz:
        wanted = [i / hz for i in range(1, int(until * hz + 1e-9) + 1)]
        rows.append((f'expected, {hz:g} Hz', wanted, EXPECTED))
    figure = Figure(figsize=(7.0, 1.6), layout='constrained')
    axes = figure.add_subplot()
    for row, (_, times, colour) in enumerate(rows):
        axes.plot(
            *(times, [row] * len(times), '|'),
            color=colour,
            markersize=18,
            markeredgewidth=2,
            clip_on=False,  # the last marker is on the frame of the plot
        )
    axes.set_yticks(range(len(rows)), [label for label, _, _ in rows])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.set_xlim(0.0, until)
    clock = "robot's clock" if recording.clock == 'simulated' else 'wall clock'
    axes.set_xlabel(f'seconds on the {clock}')
    title = f'messages on {recording.topic_name}'
    if until < recording.seconds:
        title = f'messages on {recording.topic_name}, the first {until:g} s'
    axes.set_title(title)
    return png(figure)


def draw_misread_arm(position: Sequence[float]) -> bytes | None:
    """Draw the two-link arm with these numbers read as radians; None for other arms."""
    if len(position) != 2:
        return None
    from my_robot_basics.drawing.arm import ArmPicture

    picture = ArmPicture()
    picture.move(*map(math.degrees, position), title='your numbers, read as radians')
    return picture.png()
