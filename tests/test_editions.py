"""The released editions: the same lessons with the same code, in another language."""

import re

import nbformat
import pytest
from course_maker import TOY, make_course
from my_robot_basics.language.catalogues import catalogue_path
from my_robot_basics.language.speaking import LANGUAGE
from my_robot_basics.validate.lessons.cells import KEY

from grader.authoring.edition_outputs import OutputWords
from grader.authoring.editions import editions, is_translated
from grader.authoring.leaks import files_in
from grader.authoring.release import release, stale_or_leaking
from grader.common.errors import CourseError
from grader.course import ROOT, Course

COURSE = Course()
EDITIONS = {edition.language: edition for edition in editions(COURSE)}
PAIRS = [(language, name) for language in EDITIONS for name in COURSE.assignments()]
each_lesson = pytest.mark.parametrize(('language', 'name'), PAIRS)


def both(language, name):
    """Return the English lesson and that of another language, as they are given out."""
    folder = ROOT / 'notebooks' / language / name
    return COURSE.release(name), nbformat.read(folder / f'{name}.ipynb', as_version=4)


@pytest.fixture
def toy(tmp_path):
    """A small course whose first heading is translated."""
    course = make_course(tmp_path)
    (course.root / 'locale/zh_CN/LC_MESSAGES').mkdir(parents=True)
    put(course, '# A toy', '# 玩具')
    return course


def put(course, english, translated):
    path = catalogue_path(course.root / 'locale', 'zh_CN', TOY)
    path.write_text(f'msgid "{english}"\nmsgstr "{translated}"\n', encoding='utf-8')


@pytest.mark.starts
def test_a_release_makes_an_edition_for_each_folder_of_locale(toy):
    said = []
    assert f'zh_CN/{TOY}/{TOY}.ipynb' in release(toy, say=said.append)
    made = nbformat.read(toy.root / f'notebooks/zh_CN/{TOY}/{TOY}.ipynb', as_version=4)
    assert [cell.source for cell in made.cells if is_translated(cell)] == ['# 玩具']
    assert [line for line in said if 'in English' in line] == []
    assert stale_or_leaking(toy) == []
    assert release(toy) == []
    put(toy, '# A toy', '# 玩偶')
    stale = f'notebooks/zh_CN/{TOY}/{TOY}.ipynb differs from what solutions/ gives'
    assert stale in [line.partition(':')[0] for line in stale_or_leaking(toy)]


@pytest.mark.starts
def test_a_release_says_how_much_is_not_translated(toy):
    put(toy, '# Another toy', '# 玩具')
    said = []
    release(toy, say=said.append)
    assert f'zh_CN: 1 of 1 blocks of {TOY} are in English: ./course translate lists them' in said


@pytest.mark.starts
def test_a_translation_that_reveals_an_answer_is_not_released(toy):
    put(toy, '# A toy', '# return x + x  # the secret answer')
    with pytest.raises(CourseError, match=r'nothing was released.*secret answer'):
        release(toy)


def test_there_is_a_chinese_edition():
    assert 'zh_CN' in EDITIONS


@each_lesson
def test_an_edition_differs_from_the_english_lesson_in_its_text_alone(language, name):
    english, other = both(language, name)
    assert len(english.cells) == len(other.cells)
    words = OutputWords(ROOT / 'locale', language)  # tests/test_edition_outputs.py
    for ours, theirs in zip(english.cells, other.cells, strict=True):
        if is_translated(ours):
            theirs = {**theirs, 'source': ours.source}
        for output in ours.get('outputs', []):
            words.translate(output)
        assert theirs == ours
    marks = dict(other.metadata[KEY])
    assert marks.pop(LANGUAGE) == language
    assert {**other.metadata, KEY: marks} == english.metadata


@each_lesson
def test_the_text_of_an_edition_is_that_of_its_catalogue(language, name):
    english, other = both(language, name)
    translations = EDITIONS[language].translations(name)
    for ours, theirs in zip(english.cells, other.cells, strict=True):
        if is_translated(ours):
            assert theirs.source == EDITIONS[language].text(name, ours.source)
    shown = '\n'.join(cell.source for cell in other.cells)
    for page in (ROOT / 'notebooks' / language / name).glob('*.html'):
        shown += page.read_text(encoding='utf-8')
    assert [text for text in translations.values() if text not in shown] == []


@each_lesson
def test_links_of_translated_cells_lead_to_released_files(language, name):
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
def test_links_of_the_pages_of_an_edition_lead_to_existing_files(language, page):
    text = (ROOT / 'notebooks' / language / page).read_text(encoding='utf-8')
    links = set(re.findall(r'\]\((?!https://)([^)]+)\)', text))
    assert links
    folder = ROOT / 'notebooks' / language
    assert {link for link in links if not (folder / link).is_file()} == set()


def test_the_contents_pages_of_the_languages_link_to_each_other():
    page = nbformat.read(ROOT / 'notebooks/index.ipynb', as_version=4).cells[0].source
    assert '[中文](zh_CN/index.ipynb)' in page
    page = nbformat.read(ROOT / 'notebooks/zh_CN/index.ipynb', as_version=4).cells[0].source
    assert '[English](../index.ipynb)' in page


def test_no_space_follows_a_chinese_full_stop_in_the_contents():
    cells = nbformat.read(ROOT / 'notebooks/zh_CN/index.ipynb', as_version=4).cells
    assert '解释。学完' in cells[-1].source
    assert [cell.id for cell in cells if re.search('[，。；：] ', cell.source)] == []


def test_the_chinese_contents_state_the_same_facts_for_each_lesson():
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
