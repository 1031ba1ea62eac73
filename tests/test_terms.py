"""The page of core terms: one sentence each, and a lesson that really shows the term."""

import re

import nbformat
import pytest

from grader.course import ROOT

PAGE = (ROOT / 'solutions' / 'terms.md').read_text(encoding='utf-8')
ROWS = re.findall(r'^\| (?!term |-)(.+?) \| (.+?) \| \[(\d+)\]\((.+?)\) \|$', PAGE, re.MULTILINE)
LINKS = set(re.findall(r'\]\((.+?)\)', PAGE))
each_row = pytest.mark.parametrize(
    ('term', 'meaning', 'number', 'link'), ROWS, ids=[term for term, *_ in ROWS]
)


def test_every_line_of_the_tables_of_terms_is_parsed_as_a_row():
    lines = [line for line in PAGE.splitlines() if line.startswith('|')]
    titles = [line for line in lines if line.startswith(('| term |', '|---'))]
    assert len(ROWS) == len(lines) - len(titles)


def test_no_term_is_listed_twice():
    terms = [term.lower() for term, *_ in ROWS]
    assert sorted(set(terms)) == sorted(terms)


def test_the_core_terms_of_the_course_are_listed():
    core = {'node', 'topic', 'message', 'publisher', 'subscription', 'callback', 'executor'}
    core |= {'spin', 'QoS', 'RELIABLE', 'BEST_EFFORT', 'VOLATILE', 'TRANSIENT_LOCAL', 'depth'}
    core |= {'domain ID', 'frame', 'stamp', 'entry point', 'package', 'workspace'}
    assert core - {term.strip('`') for term, *_ in ROWS} == set()


@each_row
def test_a_term_is_explained_in_one_sentence(term, meaning, number, link):
    assert re.fullmatch(r'[A-Z][^.!?]*(?:`[^`]+`[^.!?]*)*\.', meaning)
    assert len(meaning.split()) <= 30


@each_row
def test_a_term_is_used_in_the_lesson_that_it_names(term, meaning, number, link):
    assert link.startswith(f'{number:0>2}_')
    lesson = nbformat.read(ROOT / 'solutions' / link, as_version=4)
    text = '\n'.join(cell.source for cell in lesson.cells)
    assert re.search(rf'\b{re.escape(term.strip("`"))}', text, re.IGNORECASE)


@each_row
def test_the_lesson_that_explains_a_term_links_to_the_page_of_terms(term, meaning, number, link):
    lesson = nbformat.read(ROOT / 'solutions' / link, as_version=4)
    text = '\n'.join(cell.source for cell in lesson.cells if cell.cell_type == 'markdown')
    linked = re.findall(r'\[([^\]]+)\]\(\.\./terms\.md\)', text)
    assert any(words.strip('`').lower().startswith(term.strip('`').lower()) for words in linked)


@pytest.mark.parametrize('link', sorted(LINKS))
def test_links_of_the_page_of_terms_lead_to_files(link):
    assert (ROOT / 'notebooks' / link).is_file()


def test_the_first_lesson_links_to_the_page_of_terms():
    first = nbformat.read(next(ROOT.glob('solutions/00_*/*.ipynb')), as_version=4)
    assert '](../terms.md)' in first.cells[-1].source
