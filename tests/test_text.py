import csv
import io
import re

import pytest

from grader.common.text import (
    columns,
    pad,
    printable,
    shorten,
    spreadsheet_safe,
    spreadsheet_table,
    visible,
)


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
def test_printable_text_spells_out_control_characters(text, shown):
    assert printable(text) == shown


@pytest.mark.parametrize(
    ('text', 'width', 'shown'),
    [('abc', 3, 'abc'), ('abcd', 3, 'ab…'), ('小明小', 5, '小明…'), ('小明小', 6, '小明小')],
)
def test_lines_are_shortened_by_terminal_columns(text, width, shown):
    assert shorten(text, width) == shown
    assert columns(pad(shown, 10)) == 10


@pytest.mark.parametrize(
    ('text', 'width'),
    [
        ('Zoë', 3),
        ('Zoe\u0308', 3),
        ('王小明', 6),
        ('नमस्ते', 4),
        ('ไทย', 3),
        ('👩\u200d🔬', 2),
        ('👍🏽', 2),
        ('❤\ufe0f', 2),
        ('a\x07b', 2),
    ],
)
def test_a_line_has_the_columns_that_a_terminal_gives_it(text, width):
    assert columns(text) == width


@pytest.mark.parametrize(
    ('text', 'width', 'shown'),
    [('👩\u200d🔬👩\u200d🔬', 3, '👩\u200d🔬…'), ('नमस्ते', 3, 'नम…'), ('❤\ufe0fab', 3, '❤\ufe0f…')],
)
def test_a_line_is_cut_between_characters_that_a_reader_sees(text, width, shown):
    assert shorten(text, width) == shown
    assert columns(shown) <= width


HONEST = [
    '王小明', 'Ångström', 'محمد علي', 'دانش‌آموز', 'नमस्ते', 'क्‍ष', 'Zoë',
    '葛\U000e0100飾', '🤖', '👩\u200d🔬', '👍🏽', '❤\ufe0f', '3\ufe0f\u20e3', 'θ1 = 23.4°', 'ﷺ',
]  # fmt: skip


def test_marks_that_pile_up_over_other_lines_are_spelled_out():
    assert visible('a' + '\u0323\u0302' * 3 + 'b') == 'a' + '\u0323\u0302' * 3 + 'b'
    assert visible('a' + '\u0302' * 8 + 'b') == 'a' + '\u0302' * 6 + r'\u0302\u0302' + 'b'
    assert visible('a' + '\u0302\u20dd' * 4 + 'b').endswith(r'\u0302\u20ddb')
    pointed = '\u05e9\u05b8\u05bc\u05c1\u0591'  # as in the Hebrew Bible
    assert visible(pointed) == pointed


@pytest.mark.parametrize('text', HONEST)
def test_words_of_any_language_and_emoji_stay_unchanged(text):
    assert visible(text) == text
    assert printable(f'saw {text}') == f'saw {text}'


UNSEEN = [
    '\u202a', '\u202b', '\u202c', '\u202d', '\u202e', '\u2066', '\u2067', '\u2068', '\u2069',
    '\u200e', '\u200f', '\u061c', '\u200b', '\u2060', '\ufeff', '\u00ad', '\u180e', '\u3164',
    '\u115f', '\uffa0', '\u034f', '\u2028', '\u0085', '\u00a0', '\x1b', '\x07', '\x7f',
    '\U000e0041', '\ue000', '\ufff9',
]  # fmt: skip


@pytest.mark.parametrize('character', UNSEEN)
@pytest.mark.parametrize('around', ['x', '明', 'م'])
def test_invisible_characters_are_spelled_out(character, around):
    spelled = character.encode('unicode_escape').decode()
    assert visible(f'{around}{character}{around}') == f'{around}{spelled}{around}'


@pytest.mark.parametrize('text', ['a\u200db', 'a\u200c', '\u200d🔬', 'a\ufe0f', '❤\ufe0f\ufe0e'])
def test_joiners_and_selectors_stay_only_where_they_change_the_glyph(text):
    assert visible(text).count('\\u') == 1


def test_lines_and_tabs_stay_in_text_of_several_lines():
    assert visible('a\n\tb\r') == 'a\n\tb\\r'


@pytest.mark.parametrize('formula', ['=1+1', '+1', '-1', '@SUM(A1)', '\t=1', '\r=1', '＝1'])
def test_a_spreadsheet_field_that_starts_a_formula_is_quoted(formula):
    assert spreadsheet_safe(formula)[0] == "'"


def test_a_spreadsheet_field_that_starts_no_formula_is_unchanged():
    assert spreadsheet_safe('expected 5, saw = 4') == 'expected 5, saw = 4'


@pytest.mark.parametrize('mark', ['=', '+', '-', '@', '＝', '＋', '－', '＠'])
@pytest.mark.parametrize('between', [';', ',', '|', '\t', '\r', '\n', '; ', ';"', ';""', ', " '])
def test_no_part_of_a_field_becomes_a_formula_if_a_spreadsheet_splits_it(mark, between):
    """In much of Europe a spreadsheet splits at semicolons, and quotes only count at a start."""
    said = f'saw x{between}{mark}HYPERLINK("http://example.org")'
    safe = spreadsheet_safe(said)
    for cell in re.split(r'[;,|\t\r\n]', safe):
        assert not re.match(r'["\s]*[-=+@＝＋－＠]', cell)
    assert safe.replace("'", '') == printable(said)


@pytest.mark.parametrize(
    'text', ['expected 5, saw = 4', 'saw [1.5, -2.5e-3, +3]', "it's a-b; c=d", 'x, -4', '(0, -1)']
)
def test_sentences_and_lists_of_numbers_stay_as_they_are(text):
    assert spreadsheet_safe(text) == text


def test_a_number_followed_by_an_expression_is_quoted_as_a_formula():
    assert spreadsheet_safe('saw x, -2+cmd()') == "saw x, '-2+cmd()"


def test_a_table_is_written_as_safe_csv_with_a_byte_order_mark():
    rows = [['name', 'score'], ['王小明', 1.5], ['=1', -2], ['a;=1', '']]
    table = spreadsheet_table(rows).encode()
    assert table.startswith(b'\xef\xbb\xbf')
    found = list(csv.reader(io.StringIO(table.decode('utf-8-sig'))))
    assert found == [['name', 'score'], ['王小明', '1.5'], ["'=1", '-2'], ["a;'=1", '']]
