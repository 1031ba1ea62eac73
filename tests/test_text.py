import pytest

from grader.text import columns, pad, printable, shorten, spreadsheet_safe


@pytest.mark.parametrize(
    ('text', 'shown'),
    [
        ('plain words', 'plain words'),
        ('小明 Ångström', '小明 Ångström'),
        ('two\nlines\tand  spaces', 'two lines and spaces'),
        ('\x1b[31mred\x1b[0m', '\\x1b[31mred\\x1b[0m'),
        ('bell\x07 back\x08', 'bell\\x07 back\\x08'),
        ('right\u202eto left', 'right\\u202eto left'),
        ('\udcff', '\\udcff'),
    ],
)
def test_what_is_printed_moves_no_cursor(text, shown):
    assert printable(text) == shown


@pytest.mark.parametrize(
    ('text', 'width', 'shown'),
    [('abc', 3, 'abc'), ('abcd', 3, 'ab…'), ('小明小', 5, '小明…'), ('小明小', 6, '小明小')],
)
def test_lines_are_cut_by_columns(text, width, shown):
    assert shorten(text, width) == shown
    assert columns(pad(shown, 10)) == 10


@pytest.mark.parametrize('formula', ['=1+1', '+1', '-1', '@SUM(A1)', '\t=1', '\r=1'])
def test_no_field_is_a_formula(formula):
    assert spreadsheet_safe(formula)[0] == "'"


def test_other_fields_stay_as_they_are():
    assert spreadsheet_safe('expected 5, saw = 4') == 'expected 5, saw = 4'
