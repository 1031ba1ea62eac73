"""The checklist says what the lesson says, and fits on one page."""

import html
import re
from pathlib import Path

import nbformat
import pytest
from chromium import PROGRAM, launched

FOLDER = Path(__file__).parents[1] / 'solutions' / '07_common_errors'
CHECKLIST = FOLDER / 'checklist.html'
TABLES = 'method', 'fix_topic_name_task', 'own_faults'
"""Cells of the lesson whose tables the page brings together."""


def cells():
    notebook = nbformat.read(FOLDER / '07_common_errors.ipynb', as_version=4)
    return {cell.id: cell.source for cell in notebook.cells}


@pytest.mark.parametrize('cell', TABLES)
def test_the_page_has_each_command_of_the_lessons_tables(cell):
    page = html.unescape(re.sub(r'<[^>]+>', '', CHECKLIST.read_text(encoding='utf-8')))
    rows = [line for line in cells()[cell].splitlines() if line.startswith('|')]
    commands = set(re.findall(r'`([^`]+)`', ' '.join(rows)))
    assert commands
    assert {command for command in commands if command not in page} == set()


def test_the_lesson_links_to_the_checklist():
    assert '](checklist.html)' in cells()['checklist']


@pytest.mark.slow
@pytest.mark.browser
@pytest.mark.skipif(PROGRAM is None, reason='no chromium here: .ci/run installs it')
def test_the_checklist_prints_on_one_page():
    with launched() as browser:
        page = browser.new_page()
        page.goto(CHECKLIST.as_uri())
        printed = page.pdf(format='A4', prefer_css_page_size=True)
        letter = page.pdf(format='Letter', prefer_css_page_size=False)
    for pdf in printed, letter:
        assert len(re.findall(rb'/Type\s*/Page\b', pdf)) == 1
