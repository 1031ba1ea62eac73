"""Command lines of students' verbs have their help and errors in the user's language."""

import pytest
from my_robot_basics.language import speaking
from my_robot_basics.session.arguments import Arguments


def parser():
    found = Arguments(prog='./course learn')
    found.add_argument('notebook', metavar='NOTEBOOK')
    found.add_argument('--part', choices=['one', 'two'])
    return found


@pytest.fixture(params=['en', 'zh_CN'])
def language(request, monkeypatch):
    monkeypatch.delenv('JPY_SESSION_NAME', raising=False)
    monkeypatch.setenv(speaking.OF_TERMINALS, request.param)
    return request.param


HELP = {
    'en': """usage: ./course learn [-h] [--part {one,two}] NOTEBOOK

positional arguments:
  NOTEBOOK

options:
  -h, --help        show this help and exit
  --part {one,two}
""",
    'zh_CN': """用法：./course learn [-h] [--part {one,two}] NOTEBOOK

位置参数：
  NOTEBOOK

选项：
  -h, --help        显示这份帮助并退出
  --part {one,two}
""",
}
ERRORS = {
    ('en', ''): 'error: the following arguments are required: NOTEBOOK',
    ('zh_CN', ''): '错误：缺少参数：NOTEBOOK',
    ('en', 'a b'): 'error: unrecognized arguments: b',
    ('zh_CN', 'a b'): '错误：无法识别的参数：b',
    ('en', 'a --part'): 'error: argument --part: expected one argument',
    ('zh_CN', 'a --part'): '错误：参数 --part：后面要有一个值',
}


def test_the_help_is_in_the_language_of_the_terminal(language):
    shown = parser().format_help()
    assert shown == HELP[language]


@pytest.mark.parametrize('words', ['', 'a b', 'a --part'])
def test_an_error_is_in_the_language_of_the_terminal(language, words, capsys):
    with pytest.raises(SystemExit) as end:
        parser().parse_args(words.split())
    first, said = capsys.readouterr().err.splitlines()
    assert first.startswith('用法：' if language == 'zh_CN' else 'usage: ')
    assert said == f'./course learn: {ERRORS[language, words]}'
    assert end.value.code == 2


def test_a_word_that_is_no_choice_is_reported_with_the_choices(language, capsys):
    with pytest.raises(SystemExit):
        parser().parse_args(['a', '--part', 'three'])
    said = capsys.readouterr().err.splitlines()[-1]
    begin = (
        '错误：参数 --part：不能是' if language == 'zh_CN' else 'error: argument --part: invalid'
    )
    assert said.startswith(f'./course learn: {begin}')
    assert 'three' in said
    assert 'two' in said
