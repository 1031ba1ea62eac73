"""Timelines: what they draw, and their description in words."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from my_robot_basics.live import show_arrivals, show_deliveries
from my_robot_basics.live.pictures import timeline
from my_robot_basics.live.pictures.timeline import LOST, delays_sec

SENT = {number: 10.0 + 0.1 * number for number in range(5)}
ARRIVED = {0: 10.01, 2: 10.3, 4: 10.9}


@pytest.fixture
def drawn(monkeypatch):
    """The figure and the words of the last picture."""
    shown = []
    monkeypatch.setattr(timeline, 'png', lambda figure: figure)
    monkeypatch.setattr(
        timeline.notebook, 'show_picture', lambda figure, text: shown.append((figure, text))
    )
    return lambda: shown[-1]


def xs(axes, marker):
    return [x for line in axes.lines if line.get_marker() == marker for x in line.get_xdata()]


def test_each_row_begins_with_its_first_time(drawn):
    show_arrivals({'one': [5.0, 5.1, 5.3], 'two': [7.0, 7.5]}, title='both')
    figure, text = drawn()
    one, two = figure.axes
    assert xs(one, '|') == pytest.approx([0.0, 0.1, 0.3])
    assert xs(two, '|') == pytest.approx([0.0, 0.5])
    assert figure.get_suptitle() == 'both'
    assert '(s)' in two.get_xlabel()
    assert text == (
        'timeline: one: 3 times, gaps from 100.0 to 200.0 ms; '
        'two: 2 times, gaps from 500.0 to 500.0 ms'
    )


def test_gaps_are_drawn_beside_the_period_if_a_period_is_given(drawn):
    show_arrivals({'ticks': [5.0, 5.051, 5.099]}, period_sec=0.05)
    _, gaps = drawn()[0].axes
    meant, seen = gaps.lines
    assert list(meant.get_ydata()) == pytest.approx([50.0, 50.0])
    assert list(seen.get_ydata()) == pytest.approx([51.0, 48.0])
    assert '(ms)' in gaps.get_ylabel()


def test_a_busy_span_is_shaded_in_its_row_alone(drawn):
    show_arrivals({'free': [1.0, 2.0], 'busy': [3.0, 4.0]}, busy={'busy': (3.2, 3.6)})
    free, busy = drawn()[0].axes
    assert not free.patches
    [span] = busy.patches
    assert [span.get_x(), span.get_width()] == pytest.approx([0.2, 0.4])


def test_a_row_of_one_time_is_refused():
    with pytest.raises(ValueError, match='lonely: expected two times or more, got 1'):
        show_arrivals({'lonely': [1.0]})


def test_lines_join_sent_and_received_times_and_lost_messages_are_crossed(drawn):
    show_deliveries({'depth 1': ARRIVED, 'deaf': {}}, sent=SENT)
    figure, text = drawn()
    some, none = figure.axes
    assert np.reshape(xs(some, '|'), (3, 2)) == pytest.approx(
        np.array([[0.0, 0.01], [0.2, 0.3], [0.4, 0.9]])
    )
    assert xs(some, 'x') == pytest.approx([0.1, 0.3])
    assert len(xs(none, 'x')) == 5
    assert {to_hex(line.get_color()) for line in none.lines} == {LOST}
    assert text == (
        'timeline: depth 1: 3 of 5 received, the last one after 500 ms; deaf: 0 of 5 received'
    )


def test_delays_are_in_the_order_of_the_message_numbers():
    assert delays_sec(dict(reversed(ARRIVED.items())), sent=SENT) == pytest.approx(
        [0.01, 0.1, 0.5]
    )


def test_a_timeline_is_described_in_words_outside_a_notebook(capsys):
    show_deliveries({'depth 1': ARRIVED}, sent=SENT)
    show_arrivals({'ticks': [1.0, 2.0]}, period_sec=1.0)
    told = capsys.readouterr().out.splitlines()
    assert [line.partition(',')[0] for line in told] == [
        'timeline: depth 1: 3 of 5 received',
        'timeline: ticks: 2 times',
    ]
