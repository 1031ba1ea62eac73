"""Charts as plain SVG, self-contained, without scripts, and with a description in words."""

from collections import Counter
from collections.abc import Callable, Sequence

from markupsafe import Markup

MOST_BARS = 12
_BAR, _HEIGHT, _TOP, _BOTTOM = 56, 120, 22, 40
"""Pixels: a bar's width, the tallest bar's height, and the space above and below for text."""


def distribution(
    scores: Sequence[float], max_score: float, *, title: str, put: Callable[..., str] = str.format
) -> Markup:
    """Return a histogram of scores, from 0 to `max_score` points; `put` translates text."""
    bars = histogram(scores, max_score)
    tallest = max(count for _, count in bars) or 1
    width, height = _BAR * len(bars), _TOP + _HEIGHT + _BOTTOM
    told = [put('{label} points: {count}', label=label, count=count) for label, count in bars]
    alt = put('{title}. Students by score: {bars}', title=title, bars=put('; ').join(told))
    svg = Markup(
        '<svg role="img" viewBox="0 0 {w} {h}" width="{w}" height="{h}" aria-label="{alt}">'
    ).format(w=width, h=height, alt=alt)
    for place, (label, count) in enumerate(bars):
        tall = round(_HEIGHT * count / tallest)
        left, middle = place * _BAR, place * _BAR + _BAR // 2
        svg += Markup(
            '<rect x="{x}" y="{y}" width="{w}" height="{tall}" class="bar"/>'
            '<text x="{middle}" y="{above}" {style}>{count}</text>'
            '<text x="{middle}" y="{below}" {style}>{label}</text>'
        ).format(
            x=left + 4,
            y=_TOP + _HEIGHT - tall,
            w=_BAR - 8,
            tall=tall,
            middle=middle,
            above=_TOP + _HEIGHT - tall - 6,
            below=_TOP + _HEIGHT + 16,
            style=Markup('text-anchor="middle" font-size="13"'),
            count=count,
            label=label,
        )
    svg += Markup(
        '<line x1="0" x2="{w}" y1="{y}" y2="{y}"/>'
        '<text x="{middle}" y="{below}" text-anchor="middle" font-size="13">'
        '{points}</text></svg>'
    ).format(points=put('points'), w=width, y=_TOP + _HEIGHT, middle=width // 2, below=height - 6)
    return svg


def histogram(scores: Sequence[float], max_score: float) -> list[tuple[str, int]]:
    """Return label and count of each bar; a bar includes its lower limit, the last one both."""
    step = max(1, -(-int(max_score) // MOST_BARS))
    last = int(max_score) // step
    counts = Counter(min(last, int(max(0.0, score) // step)) for score in scores)
    return [(_label(bar, step, max_score), counts[bar]) for bar in range(last + 1)]


def _label(bar: int, step: int, max_score: float) -> str:
    end = min(max_score, (bar + 1) * step - 1)
    return f'{bar * step}–{end:g}' if step > 1 and end > bar * step else f'{bar * step}'


def share_bar(part: float, *, label: str) -> Markup:
    """Return a bar that is filled to `part`, from 0 to 1."""
    return Markup(
        '<svg role="img" viewBox="0 0 100 12" width="100" height="12" aria-label="{label}">'
        '<rect width="100" height="12" class="track"/>'
        '<rect width="{filled:.0f}" height="12" class="bar"/></svg>'
    ).format(label=label, filled=100 * part)
