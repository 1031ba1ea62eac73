import re

import pytest

from grader.report.charts import distribution, histogram, share_bar


@pytest.mark.parametrize(
    ('scores', 'max_score', 'bars'),
    [
        ((0, 0.5, 1, 3), 3, [('0', 2), ('1', 1), ('2', 0), ('3', 1)]),
        ((-1, 9), 2, [('0', 1), ('1', 0), ('2', 1)]),
        ((2.5,), 2.5, [('0', 0), ('1', 0), ('2', 1)]),
        ((), 0, [('0', 0)]),
    ],
)
def test_each_score_is_in_one_bar(scores, max_score, bars):
    assert histogram(scores, max_score) == bars


@pytest.mark.parametrize('max_score', [12, 13, 20, 24, 25, 100, 1000])
def test_a_histogram_has_at_most_13_bars_and_counts_every_student(max_score):
    bars = histogram(range(max_score + 1), max_score)
    assert len(bars) <= 13
    assert sum(count for _, count in bars) == max_score + 1
    assert bars[-1][0].endswith(str(max_score))


def test_a_chart_says_in_words_what_it_shows_and_escapes_its_title():
    svg = distribution([0, 2, 2], 2, title='Scores of <b>"us"')
    assert 'role="img"' in svg
    assert 'Students by score: 0 points: 1; 1 points: 0; 2 points: 2' in svg
    assert '<b>' not in svg
    assert '"us"' not in svg
    heights = [int(tall) for tall in re.findall(r'<rect [^>]*height="(\d+)"', svg)]
    assert heights == [60, 0, 120]


def test_the_bar_of_a_share_has_the_width_of_its_value():
    assert 'aria-label="a quarter"' in share_bar(0.25, label='a quarter')
    assert '<rect width="25" ' in share_bar(0.25, label='a quarter')
