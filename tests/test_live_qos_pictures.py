"""Pictures of matching QoS profiles and of lost messages, and their descriptions in words."""

import numpy as np
import pytest
from my_robot_basics.live import show_lost_messages, show_qos_matrix
from my_robot_basics.live.output import notebook
from my_robot_basics.live.pictures import qos_pictures

OUTCOMES = {
    ('RELIABLE VOLATILE', 'RELIABLE VOLATILE'): 'yes',
    ('RELIABLE VOLATILE', 'none'): 'yes',
    ('none', 'RELIABLE VOLATILE'): 'RELIABILITY',
    ('none', 'none'): 'yes',
}


@pytest.fixture
def shown(monkeypatch):
    """The bundles that are displayed."""
    bundles = []

    class Display:
        def show(self, bundle):
            bundles.append(bundle)

    monkeypatch.setattr(notebook, 'Display', Display)
    return bundles


def test_a_qos_matrix_is_drawn_and_lists_each_outcome_in_words(shown):
    show_qos_matrix(OUTCOMES, title='who reaches whom')
    [bundle] = shown
    assert bundle['image/png'].startswith(b'\x89PNG')
    assert bundle['text/plain'].splitlines() == [
        'who reaches whom',
        'RELIABLE VOLATILE → RELIABLE VOLATILE yes, none yes',
        'none → RELIABLE VOLATILE no (RELIABILITY), none yes',
    ]


def test_each_outcome_is_drawn_in_the_row_and_column_of_its_pair():
    names = ['RELIABLE VOLATILE', 'none']
    figure = qos_pictures._draw_matrix(OUTCOMES, offers=names, requests=names, title='t')
    [axes] = figure.axes
    words = {text.get_position(): text.get_text() for text in axes.texts}
    assert words == {
        (0.5, 0.5): 'yes',
        (1.5, 0.5): 'yes',
        (0.5, 1.5): 'no\nRELIABILITY',
        (1.5, 1.5): 'yes',
    }
    # the first row is above the second
    assert axes.get_ylim() == (2, 0)
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ['RELIABLE\nVOLATILE', 'none']
    assert 'offers' in axes.get_ylabel()
    assert 'requests' in axes.get_xlabel()


def test_a_matrix_with_a_missing_outcome_is_refused():
    holed = {pair: outcome for pair, outcome in OUTCOMES.items() if pair != ('none', 'none')}
    with pytest.raises(ValueError, match=r"saw none for \('none', 'none'\)"):
        show_qos_matrix(holed)


def test_lost_messages_are_counted_and_crossed(shown):
    heard = {'all': [1, 2, 3, 4], 'few': [4, 2, 2, 99], 'nobody': []}
    show_lost_messages(heard, sent=4, title='pictures')
    assert shown[0]['text/plain'].splitlines() == [
        'pictures',
        'all: 4 of 4',
        'few: 2 of 4',
        'nobody: 0 of 4',
    ]
    [axes] = qos_pictures._draw_lost(heard, sent=4, title='pictures').axes
    points = [[*line.get_xdata()] for line in axes.lines]
    assert points == [[1, 2, 3, 4], [], [2, 4], [1, 3], [], [1, 2, 3, 4]]
    assert {line.get_marker() for line in axes.lines} == {'|', 'x'}
    assert axes.get_xlabel() == 'message number'


def test_black_is_easily_read_in_every_cell():
    for colour in qos_pictures.YES, qos_pictures.NO:
        channels = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        linear = np.where(
            channels > 0.04045, ((channels + 0.055) / 1.055) ** 2.4, channels / 12.92
        )
        luminance = linear @ [0.2126, 0.7152, 0.0722]
        assert (luminance + 0.05) / 0.05 > 7  # WCAG 2, level AAA
