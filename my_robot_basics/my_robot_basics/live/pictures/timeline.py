"""Pictures of when messages arrive: how evenly, how late, and which are lost."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.live.output import notebook

# Okabe and Ito's palette, for colour-blind readers; lost messages also have another shape
ARRIVED, LOST, BUSY = '#0072b2', '#d55e00', '#e69f00'
WIDTH_INCHES, STRIP_INCHES, PANEL_INCHES = 7.0, 0.55, 1.3


def show_arrivals(
    rows: Mapping[str, Sequence[float]],
    *,
    period_sec: float | None = None,
    busy: Mapping[str, tuple[float, float]] | None = None,
    title: str = '',
) -> None:
    """Show when events happened, one strip for each label: times in seconds, oldest first.

    Each strip begins with its own first time. With `period_sec`, the gap from each time to the
    one before is drawn below, together with the intended period. `busy` has, for a label, a span
    of time to shade. Raises ValueError for a row with fewer than two times.
    """
    for label, times_sec in rows.items():
        if len(times_sec) < 2:
            raise ValueError(f'{label}: expected two times or more, got {len(times_sec)}')
    heights = [STRIP_INCHES] if period_sec is None else [STRIP_INCHES, PANEL_INCHES]
    figure, panels = _panels(heights * len(rows), title=title)
    for label, times_sec in rows.items():
        strip = next(panels)
        since_sec = np.subtract(times_sec, times_sec[0])
        strip.plot(since_sec, np.zeros(len(since_sec)), '|', color=ARRIVED, ms=14)
        strip.set_title(_gaps(label, times_sec), fontsize=9, loc='left')
        strip.set(yticks=[], ylim=(-1, 1))
        if busy and label in busy:
            span_sec = np.subtract(busy[label], times_sec[0])
            strip.axvspan(*span_sec, color=BUSY, alpha=0.4, lw=0, zorder=0)
        if period_sec is not None:
            gaps = next(panels)
            gaps.axhline(1e3 * period_sec, color='0.5', lw=1, ls='--')
            gaps.plot(since_sec[1:], 1e3 * np.diff(since_sec), 'o', color=ARRIVED, ms=4)
            gaps.set_ylabel('gap (ms)')
            gaps.ticklabel_format(useOffset=False)
    figure.axes[-1].set_xlabel('time since the first one (s)')
    notebook.show_picture(
        png(figure), _describe_timeline(_gaps(label, times) for label, times in rows.items())
    )


def show_deliveries(
    rows: Mapping[str, Mapping[int, float]], *, sent: Mapping[int, float], title: str = ''
) -> None:
    """Show when numbered messages were sent and received, one row for each receiver.

    All times are in seconds on one clock. A line goes from each message to its arrival: the
    flatter it is, the longer the message waited. A message that never arrived is a cross.
    """
    figure, panels = _panels([PANEL_INCHES] * len(rows), title=title)
    start_sec = min(sent.values())
    for axes, (label, arrived) in zip(panels, rows.items(), strict=True):
        for number, sent_sec in sent.items():
            if number in arrived:
                way_sec = [sent_sec - start_sec, arrived[number] - start_sec]
                axes.plot(way_sec, [1, 0], '|-', color=ARRIVED, lw=0.8, ms=8)
            else:
                axes.plot([sent_sec - start_sec], [1], 'x', color=LOST, ms=6)
        axes.set_title(_delays(label, arrived, sent), fontsize=9, loc='left')
        axes.set_title('× = never received', fontsize=9, loc='right', color=LOST)
        axes.set(yticks=[1, 0], yticklabels=['sent', 'received'], ylim=(-0.3, 1.3))
    figure.axes[-1].set_xlabel('time since the first message was sent (s)')
    notebook.show_picture(
        png(figure), _describe_timeline(_delays(label, each, sent) for label, each in rows.items())
    )


def delays_sec(arrived: Mapping[int, float], *, sent: Mapping[int, float]) -> list[float]:
    """Return the delay of each message that arrived, in the order of their numbers."""
    return [arrived[number] - sent[number] for number in sorted(arrived) if number in sent]


def _gaps(label: str, times_sec: Sequence[float]) -> str:
    gaps_ms = 1e3 * np.diff(times_sec)
    return f'{label}: ' + gettext_noop(
        f'{len(times_sec)} times, gaps from {gaps_ms.min():.1f} to {gaps_ms.max():.1f} ms'
    )


def _delays(label: str, arrived: Mapping[int, float], sent: Mapping[int, float]) -> str:
    delays = delays_sec(arrived, sent=sent)
    if not delays:
        return f'{label}: ' + gettext_noop(f'0 of {len(sent)} received')
    last_ms = 1e3 * delays[-1]
    return f'{label}: ' + gettext_noop(
        f'{len(delays)} of {len(sent)} received, the last one after {last_ms:.0f} ms'
    )


def _panels(heights_inches: Sequence[float], *, title: str) -> tuple:
    """Make a figure with panels below each other; return it, and an iterator over them."""
    from matplotlib.figure import Figure  # takes a second

    size = (WIDTH_INCHES, 0.5 + 1.3 * sum(heights_inches) + 0.3 * bool(title))
    figure = Figure(figsize=size, dpi=80, layout='constrained')
    if title:
        figure.suptitle(title, fontsize=10)
    count = len(heights_inches)
    panels = figure.subplots(count, 1, sharex=True, squeeze=False, height_ratios=heights_inches)
    return figure, iter(panels[:, 0])


def _describe_timeline(rows: Iterable[str]) -> str:
    return gettext_noop('timeline') + ': ' + '; '.join(rows)
