"""The examples of CONTRIBUTING.md work exactly as written."""

import ast
import re
import sys
from textwrap import dedent
from types import ModuleType

import pytest

from grader.collect import platforms
from grader.course import ROOT
from my_robot_basics import checks

PAGE = (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')


def blocks_of(section):
    """Return the blocks of Python in a section."""
    text = PAGE.partition(f'\n## {section}\n')[2].partition('\n## ')[0]
    blocks = re.findall(r'^ *```python\n(.*?)^ *```', text, re.MULTILINE | re.DOTALL)
    return [dedent(block) for block in blocks]


@pytest.fixture
def example(monkeypatch):
    """Make the check of the page, and its row."""
    module = ModuleType('my_robot_basics.checks.topics.example')
    exec(blocks_of('A check')[0], vars(module))
    monkeypatch.setitem(sys.modules, module.__name__, module)
    (row,) = re.findall(r"`('expect_text': '.+?')`", PAGE)
    for name, home in ast.literal_eval(f'{{{row}}}').items():
        monkeypatch.setitem(checks._HOMES, name, home)
    return module


def test_the_row_of_a_check_makes_it_public(example):
    assert checks.expect_text is example.expect_text


@pytest.mark.parametrize(
    'name', ['test_the_expected_text_passes', 'test_another_text_is_reported']
)
def test_the_test_of_a_check_passes(name, example, run):
    names = {}
    exec(blocks_of('A check')[1], names)
    names[name](run)


def test_the_row_of_a_platform_reads_its_names(monkeypatch):
    brightspace = eval(blocks_of('A collect format')[0], vars(platforms))
    monkeypatch.setattr(platforms, 'PLATFORMS', (*platforms.PLATFORMS, brightspace))
    (name,) = re.findall(r'`(12345-.+?)`', PAGE)
    label = platforms.label_in(name)
    assert (label.platform, label.number, label.student) == (brightspace, '12345', 'Ada Lovelace')
    assert platforms.student_in(name) == 'Ada Lovelace'


def test_the_example_lesson_has_a_number_that_no_existing_lesson_has():
    (number,) = set(re.findall(r'\b(\d\d)_example\b', PAGE))
    lessons = {path.parent.name for path in ROOT.glob('solutions/*/*.ipynb')}
    assert '08_services' in lessons
    assert [name for name in lessons - {f'{number}_example'} if name.startswith(number)] == []
