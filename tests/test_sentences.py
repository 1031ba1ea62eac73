"""Templates are collected from code, and a sentence made from them is translated."""

import pytest
from my_robot_basics.language.sentences import MOST_CHARACTERS, Sentences
from my_robot_basics.language.templates import Template

from grader.authoring.code_messages import alt_text_messages_in, messages_in

CODE = '''
"""Each value is doubled

More on that.
"""
import re
from x import fail

PATTERN = re.compile('one two (three)')

def check(seen, n):
    """It is the same for all."""
    if seen is None:
        raise ValueError('our own mistake')
    text = f'over {n:g} s ({len(seen)} message{"" if n == 1 else "s"})'
    fail(
        expected=f'{seen.name} {"above" if n else "below"} the line',
        seen=seen or 'nothing',
        hint='double {it: twice}, ' + text + ' each time',
    )
'''


NOT_READ = """
import argparse

parser = argparse.ArgumentParser('./course lab', prog='./course so', usage='run [one two] and end')
HERE = '__import__("a.b", fromlist=["one"])'

def check(seen, kind, name):
    if seen.endswith('is not callable') or seen.startswith('Traceback (most recent call'):
        raise AssertionError('it always has an end')
    Finding(code='a = [one for one in two]', fix='this is read')
    print(f'a: {in_language_here(kind)}', 'import a' + f' as {name}')
    return ('true' if seen else 'false'), ('code' if kind else 'markdown')
"""


def test_strings_that_nobody_reads_are_not_collected_as_sentences():
    assert messages_in(NOT_READ) == ['this is read', 'code']


def test_sentences_in_code_become_templates_with_named_placeholders():
    assert messages_in(CODE, title=True) == [
        'over {n} s ({len} message{value})',
        '{name} {value} the line',
        'double {it: twice}, {text} each time',
        'Each value is doubled',
        'It is the same for all.',
        'nothing',
        'above',
        'below',
    ]
    assert 'Each value is doubled' not in messages_in(CODE)


def test_only_marked_words_of_a_picture_are_collected():
    marked = "gettext_noop('graph') + f': {a}' + gettext_noop(f'{len(a)} of {b:g} ms')"
    assert alt_text_messages_in(marked) == ['graph', '{len} of {b} ms']


TEMPLATES = {
    'expected {expected}, saw {seen}: {hint}': '预期：{expected}；实际：{seen}。{hint}',
    'no message in {seconds} s': '{seconds} s 内没有消息',
    'over {seconds} s ({n} message{value})': '{seconds} s 内（{n} 条消息）',
    'the period is in seconds': '周期以秒为单位',
    '`{name}` to return {wanted}': '`{name}` 返回 {wanted}',
    'your cell ': '你的单元格 ',
    ', without quotes': '，不加引号',
    'it ended': '它结束了',
    'All checks pass.': '检查全部通过。',
    '{number} of {total} points are open.': '{total} 分中有 {number} 分未定。',
    '{one} and {other}': '{one} 和 {other}',
    '{one} {other}': '{one}，{other}',
    '{sentence} {other}': '{sentence}{other}',
    '{name} is {value}': '{name} 为 {value}',
    '{len} wrong': '{len} 个错误',
}
SAID = {
    'expected 5.0 Hz, saw no message in 10 s: the period is in seconds': (
        '预期：5.0 Hz；实际：10 s 内没有消息。周期以秒为单位'
    ),
    'expected 5.0 Hz, saw 1.0 Hz over 2 s (1 message): the period is in seconds': (
        '预期：5.0 Hz；实际：1.0 Hz，2 s 内（1 条消息）。周期以秒为单位'
    ),
    'expected `f(is, and)` to return True, saw None: it ended': (
        '预期：`f(is, and)` 返回 True；实际：None。它结束了'
    ),
    'your cell `a` ended': '你的单元格 `a` ended',
    'True, without quotes': 'True，不加引号',
    'All checks pass. 1 of 3 points are open.': '检查全部通过。3 分中有 1 分未定。',
    '/a and /b': '/a 和 /b',
    'your cell it ended': '你的单元格它结束了',
    'what the student is told and what is not': 'what the student is told and what is not',
    'nobody knows this sentence': 'nobody knows this sentence',
    '12 wrong': '12 个错误',
    '… wrong': '… 个错误',
    'all that I typed, 2 wrong': 'all that I typed, 2 wrong',
    '': '',
}


@pytest.mark.parametrize(('english', 'chinese'), SAID.items())
def test_a_sentence_is_translated_by_the_templates_that_fit_it(english, chinese):
    assert Sentences(TEMPLATES).translate(english) == chinese


@pytest.mark.parametrize(
    'text', ['a, b' * 400, 'x is ' * 300, 'a and ' * 300, '. ' * 900, 'x' * (MOST_CHARACTERS + 1)]
)
def test_arbitrary_text_is_translated_in_a_bounded_number_of_tries(monkeypatch, text):
    searches, begin = [], Sentences._search
    monkeypatch.setattr(
        Sentences, '_search', lambda self: searches.append(begin(self)) or searches[-1]
    )
    assert isinstance(Sentences(TEMPLATES).translate(text), str)
    assert all(search._tries < 10_000 for search in searches)
    assert len(searches) == (len(text) <= MOST_CHARACTERS)


@pytest.mark.timeout(60)
def test_a_template_that_does_not_fit_is_given_up_at_once():
    template = Template.of('{a} in {b} of {c} at {d} to {e} on {f} by {g}.', '')
    assert list(template.fits(' by ' + ' in  of  at  to  on ' * 80 + '.')) == []
    assert [*template.fits('1 in 2 of 3 of 4 at 5 to 6 on 7 by 8.')] == [
        {'a': '1', 'b': '2', 'c': '3 of 4', 'd': '5', 'e': '6', 'f': '7', 'g': '8'},
        {'a': '1', 'b': '2 of 3', 'c': '4', 'd': '5', 'e': '6', 'f': '7', 'g': '8'},
    ]
