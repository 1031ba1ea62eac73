import pytest

from grader.report.message_groups import CellMessage, group_messages, without_numbers


@pytest.mark.parametrize(
    ('reason', 'words'),
    [
        ('saw 23.5 at joint1: -4e-05 rad', 'saw … at joint1: … rad'),
        ('saw (1, 2.0, -3) and 7', 'saw (…) and …'),
        ('03_publisher.ipynb has no number, nor has joint1', None),
    ],
)
def test_reasons_are_grouped_by_their_words_without_the_numbers(reason, words):
    assert without_numbers(reason) == (words or reason)


def test_messages_that_differ_only_in_numbers_are_one_reason_per_assignment():
    said = [
        CellMessage('ada', 'one', 'a', 'saw 1'),
        CellMessage('bob', 'one', 'b', 'saw 2'),
        CellMessage('bob', 'one', 'a', 'saw 3'),
        CellMessage('eve', 'two', '', 'saw 1'),
        CellMessage('\x1b', 'two', '', 'saw 1'),
        CellMessage('zoe', 'two', 'a', 'heard 1'),
    ]
    found = [
        (r.assignment, r.words, r.example, r.students, r.checks) for r in group_messages(said)
    ]
    assert found == [
        ('one', 'saw …', 'saw 1', ('ada', 'bob'), ('a', 'b')),
        ('two', 'saw 1', 'saw 1', ('eve', '\\x1b'), ()),
        ('two', 'heard 1', 'heard 1', ('zoe',), ('a',)),
    ]


@pytest.mark.parametrize(
    ('one', 'other', 'words'),
    [
        (
            'saw 4.0 Hz: period = 1 / rate',
            'saw 6.0 Hz: period = 1 / rate',
            'saw … Hz: period = 1 / rate',
        ),
        ('saw 1, 2, 3 of 4', 'saw 1, 5, 6 of 4', 'saw 1, … of 4'),
        ('saw (1, 2)', 'saw (1, 2, 3)', 'saw (…)'),
        ('saw 7', 'saw 7', 'saw 7'),
    ],
)
def test_a_number_that_all_messages_share_is_kept_in_the_reason(one, other, words):
    [reason] = group_messages(
        [CellMessage('ada', 'one', 'a', one), CellMessage('bob', 'one', 'a', other)]
    )
    assert reason.words == words
