"""A failing check is one sentence, in Python and in IPython."""

import numpy as np
import pytest
from IPython.core.interactiveshell import InteractiveShell
from my_robot_basics.checks import CheckFailed, expect, fail
from my_robot_basics.feedback.errors import shorten, shorten_exception

WORDS = {'expected': '5.0 Hz', 'seen': '1.0 Hz', 'hint': 'period = 1 / rate'}
SENTENCE = 'expected 5.0 Hz, saw 1.0 Hz: period = 1 / rate'


@pytest.mark.parametrize('condition', [False, np.bool_(False)])
def test_expect_says_expected_seen_and_hint(condition):
    with pytest.raises(CheckFailed) as failed:
        expect(condition, **WORDS)
    assert str(failed.value) == SENTENCE


@pytest.mark.parametrize('condition', [True, np.bool_(True)])
def test_expect_is_silent_when_the_condition_holds(condition):
    assert expect(condition, **WORDS) is None


@pytest.mark.parametrize('condition', [(False, 'text'), None, 1, 'text', []])
def test_expect_refuses_what_is_not_a_bool(condition):
    with pytest.raises(TypeError, match='takes a bool'):
        expect(condition, **WORDS)


def test_a_long_sentence_is_shown_in_lines_and_kept_whole():
    with pytest.raises(CheckFailed) as failed:
        fail(expected='words ' * 15, seen='more words ' * 15, hint='`self.create_timer(0.2, …)`')
    lines = failed.value._render_traceback_()
    assert len(lines) > 2
    assert max(map(len, lines)) <= 90
    assert ' '.join(lines).split() == str(failed.value).split()
    assert '\n' not in str(failed.value)


def test_ipython_shows_the_sentence_and_no_source(capsys):
    shell = InteractiveShell()
    shell.run_cell(
        'from my_robot_basics.checks import fail\n'
        "hidden = 1; fail(expected='5.0 Hz', seen='1.0 Hz', hint='period = 1 / rate')"
    )
    shown = capsys.readouterr()
    assert shown.out.strip() == SENTENCE
    assert 'hidden' not in shown.out + shown.err


def test_fail_always_raises():
    with pytest.raises(AssertionError, match='period = 1 / rate'):
        fail(**WORDS)


@pytest.mark.parametrize(
    ('text', 'expected'),
    [('a\n  b', 'a b'), ('\x1b[31mred', '?[31mred'), ('a' * 300, 'a' * 199 + '…'), (5, '5')],
)
def test_shorten_makes_one_printable_line(text, expected):
    assert shorten(text) == expected


@pytest.mark.parametrize(
    ('said', 'expected'),
    [
        (
            'ValueError: no\n  more (line 4, in f: g(x))',
            'ValueError: no more (line 4, in f: g(x))',
        ),
        (f'E: {"a" * 300} (line 4, in f: g(x))', f'E: {"a" * 175}… (line 4, in f: g(x))'),
        (f'E: no (line 4, in f: {"g" * 200})', f'E: no (line 4, in f: {"g" * 85}…)'),
        ('E: ' + 'a' * 300, 'E: ' + 'a' * 196 + '…'),
    ],
)
def test_a_long_exception_keeps_the_line_where_it_was_raised(said, expected):
    assert shorten_exception(said) == expected
    assert len(expected) <= 200
