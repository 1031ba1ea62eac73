"""Pictures of compatible QoS profiles, and of lost messages."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.drawing.figures import png
from my_robot_basics.live.output import notebook

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Okabe and Ito's palette, for colour-blind readers; words or shapes show the same
ARRIVED, LOST = '#0072b2', '#d55e00'
YES, NO = '#cce3f0', '#f7dfcc'
"""Light versions of the two, on which black text is easy to read."""
LONG = 12
"""Characters of a label that fit in one line."""


def show_qos_matrix(outcomes: Mapping[tuple[str, str], str], *, title: str = '') -> None:
    """Show a table of pairs (offered, requested) with the outcome of each.

    An outcome is 'yes' if a message arrived, else the name of the incompatible policy.
    Raises ValueError if a pair is missing.
    """
    offers, requests = ([*dict.fromkeys(names)] for names in zip(*outcomes, strict=True))
    holes = [(o, r) for o in offers for r in requests if (o, r) not in outcomes]
    if holes:
        raise ValueError(f'expected an outcome for every pair, saw none for {holes[0]}')
    lines = [
        f'{offer} → '
        + ', '.join(_describe_outcome(request, outcomes[offer, request]) for request in requests)
        for offer in offers
    ]
    figure = _draw_matrix(outcomes, offers=offers, requests=requests, title=title)
    notebook.show_picture(png(figure), '\n'.join(filter(None, [title, *lines])))


def show_lost_messages(
    received: Mapping[str, Sequence[int]], *, sent: int, title: str = ''
) -> None:
    """Show, for each subscription, which of the messages 1 to `sent` it received."""
    counts = [
        f'{name}: ' + gettext_noop(f'{len(_received_numbers(numbers, sent))} of {sent}')
        for name, numbers in received.items()
    ]
    figure = _draw_lost(received, sent=sent, title=title)
    notebook.show_picture(png(figure), '\n'.join(filter(None, [title, *counts])))


def _describe_outcome(request: str, outcome: str) -> str:
    if outcome == 'yes':
        return gettext_noop(f'{request} yes')
    return gettext_noop(f'{request} no ({outcome})')


def _received_numbers(numbers: Sequence[int], sent: int) -> list[int]:
    return sorted({*numbers} & {*range(1, sent + 1)})


def _draw_matrix(
    outcomes: Mapping[tuple[str, str], str],
    *,
    offers: Sequence[str],
    requests: Sequence[str],
    title: str,
) -> 'Figure':
    from matplotlib.figure import Figure  # takes a second, and not every lesson needs it

    rows, columns = len(offers), len(requests)
    figure = Figure(figsize=(2.2 + 1.4 * columns, 1.4 + 0.6 * rows), dpi=80, layout='constrained')
    axes = figure.add_subplot(xlim=(0, columns), ylim=(rows, 0))
    axes.set_title(title)
    axes.set_xlabel('the subscription requests')
    axes.set_ylabel('the publisher offers')
    axes.set_xticks([i + 0.5 for i in range(columns)], [_break_label(name) for name in requests])
    axes.set_yticks([i + 0.5 for i in range(rows)], [_break_label(name) for name in offers])
    axes.tick_params(length=0)
    for row, offer in enumerate(offers):
        for column, request in enumerate(requests):
            outcome = outcomes[offer, request]
            axes.fill_between(
                *([column, column + 1], row, row + 1),
                color=YES if outcome == 'yes' else NO,
                edgecolor='white',
                linewidth=3,
            )
            text = 'yes' if outcome == 'yes' else f'no\n{outcome}'
            axes.text(column + 0.5, row + 0.5, text, ha='center', va='center', fontsize=10)
    return figure


def _break_label(name: str) -> str:
    return name.replace(' ', '\n', 1) if len(name) > LONG else name


def _draw_lost(received: Mapping[str, Sequence[int]], *, sent: int, title: str) -> 'Figure':
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 1.1 + 0.5 * len(received)), dpi=80, layout='constrained')
    axes = figure.add_subplot(xlim=(0, sent + 1), ylim=(len(received) - 0.5, -0.5))
    labels = []
    for row, (name, numbers) in enumerate(received.items()):
        known = _received_numbers(numbers, sent)
        lost = [number for number in range(1, sent + 1) if number not in known]
        axes.plot(known, [row] * len(known), '|', color=ARRIVED, ms=16, mew=3, label='arrived')
        axes.plot(lost, [row] * len(lost), 'x', color=LOST, ms=5, label='lost')
        labels.append(f'{name}\n{len(known)} of {sent}')
    axes.set_yticks(range(len(received)), labels)
    axes.locator_params(axis='x', integer=True)
    axes.set_xlabel('message number')
    axes.set_title(title)
    handles, names = axes.get_legend_handles_labels()
    figure.legend(handles[:2], names[:2], loc='outside right upper', markerscale=0.6)
    return figure
