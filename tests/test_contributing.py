"""The examples of CONTRIBUTING.md work as they stand there."""

import ast
import re
import sys
from textwrap import dedent
from types import ModuleType

from grader.collect import platforms
from grader.course import ROOT
from my_robot_basics import checks

PAGE = (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')


def block_of(section):
    """Return the first block of Python in a section."""
    text = PAGE.partition(f'\n## {section}\n')[2].partition('\n## ')[0]
    return dedent(re.search(r'^ *```python\n(.*?)^ *```', text, re.MULTILINE | re.DOTALL)[1])


def test_the_row_of_a_check_makes_it_public(monkeypatch):
    module = ModuleType('my_robot_basics.checks.example')
    exec(block_of('A check'), vars(module))
    monkeypatch.setitem(sys.modules, module.__name__, module)
    (row,) = re.findall(r"`('expect_text': '.+?')`", PAGE)
    for name, home in ast.literal_eval(f'{{{row}}}').items():
        monkeypatch.setitem(checks._HOMES, name, home)
    assert checks.expect_text is module.expect_text


def test_the_row_of_a_platform_reads_its_names(monkeypatch):
    brightspace = eval(block_of('A collect format'), vars(platforms))
    monkeypatch.setattr(platforms, 'PLATFORMS', (*platforms.PLATFORMS, brightspace))
    (name,) = re.findall(r'`(12345-.+?)`', PAGE)
    label = platforms.label_in(name)
    assert (label.platform, label.number, label.who) == (brightspace, '12345', 'Ada Lovelace')
    assert platforms.student_in(name) == 'Ada Lovelace'
