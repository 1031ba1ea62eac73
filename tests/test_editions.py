"""The released editions: the same lessons with the same code, in another language."""

import re

import nbformat
import pytest
from my_robot_basics.validate.cells import KEY

from grader.authoring.editions import LANGUAGE, editions, is_translated
from grader.authoring.leaks import files_in
from grader.course import ROOT, Course

COURSE = Course()
EDITIONS = {edition.language: edition for edition in editions(COURSE)}
PAIRS = [(language, name) for language in EDITIONS for name in COURSE.assignments()]
each_lesson = pytest.mark.parametrize(('language', 'name'), PAIRS)


def both(language, name):
    """Return the English lesson and that of another language, as they are given out."""
    folder = ROOT / 'notebooks' / language / name
    return COURSE.release(name), nbformat.read(folder / f'{name}.ipynb', as_version=4)


def test_there_is_a_chinese_edition():
    assert 'zh_CN' in EDITIONS


@each_lesson
def test_all_but_the_text_is_the_same_in_each_byte(language, name):
    english, other = both(language, name)
    assert len(english.cells) == len(other.cells)
    for ours, theirs in zip(english.cells, other.cells, strict=True):
        if is_translated(ours):
            theirs = {**theirs, 'source': ours.source}
        assert theirs == ours
    marks = dict(other.metadata[KEY])
    assert marks.pop(LANGUAGE) == language
    assert {**other.metadata, KEY: marks} == english.metadata


@each_lesson
def test_the_text_is_what_the_catalogue_says(language, name):
    english, other = both(language, name)
    translations = EDITIONS[language].translations(name)
    for ours, theirs in zip(english.cells, other.cells, strict=True):
        if is_translated(ours):
            assert theirs.source == EDITIONS[language].text(name, ours.source)
    shown = '\n'.join(cell.source for cell in other.cells)
    assert [text for text in translations.values() if text not in shown] == []


@each_lesson
def test_links_lead_to_what_is_given_out(language, name):
    folder = ROOT / 'notebooks' / language / name
    text = '\n'.join(cell.source for cell in both(language, name)[1].cells if is_translated(cell))
    links = set(re.findall(r'\]\((?!https://)([^)]+)\)', text))
    assert links
    assert {link for link in links if not (folder / link).is_file()} == set()


@pytest.mark.parametrize('language', EDITIONS)
def test_an_edition_has_the_files_of_the_english_one(language):
    released = [path for path in files_in(ROOT / 'notebooks') if path.parts[0] not in EDITIONS]
    assert files_in(ROOT / 'notebooks' / language) == released


@pytest.mark.parametrize('language', EDITIONS)
@pytest.mark.parametrize('page', ['index.ipynb', 'terms.md', 'what_next.md'])
def test_the_links_of_its_pages_lead_somewhere(language, page):
    text = (ROOT / 'notebooks' / language / page).read_text(encoding='utf-8')
    links = set(re.findall(r'\]\((?!https://)([^)]+)\)', text))
    assert links
    folder = ROOT / 'notebooks' / language
    assert {link for link in links if not (folder / link).is_file()} == set()


def test_the_contents_lead_to_the_other_languages_and_back():
    page = nbformat.read(ROOT / 'notebooks/index.ipynb', as_version=4).cells[0].source
    assert '[中文](zh_CN/index.ipynb)' in page
    page = nbformat.read(ROOT / 'notebooks/zh_CN/index.ipynb', as_version=4).cells[0].source
    assert '[English](../index.ipynb)' in page


def test_the_chinese_contents_say_the_same_of_each_lesson():
    row = re.compile(r'^\| \[(.+?)\]\((.+?)\) \| .+ \| (\d+) \| (.+?) \| (\d+) \|$', re.MULTILINE)
    pages = [
        nbformat.read(ROOT / 'notebooks' / path, as_version=4).cells[0].source
        for path in ('index.ipynb', 'zh_CN/index.ipynb')
    ]
    english, chinese = ([found[1:] for found in row.findall(page)] for page in pages)
    assert len(english) == len(COURSE.assignments())
    assert english == chinese
    assert '只' not in pages[0]
    assert '[0 · 两连杆机械臂：热身]' in pages[1]
