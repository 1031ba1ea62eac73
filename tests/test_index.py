"""The table of contents says what the lessons say, and leads to them."""

import re

import nbformat
import pytest
from course_maker import TOY, make_course, toy_lesson, write_source

from grader.authoring.contents_rows import progress_row
from grader.authoring.index import make_index, write_pages
from grader.course import ROOT, Course

INDEX = nbformat.read(ROOT / 'notebooks' / 'index.ipynb', as_version=4)
TEXT = '\n\n'.join(cell.source for cell in INDEX.cells)
ROW = r'^\| \[(.+?)\]\((.+?)\) \| (.+?) \| (.+?) \| (\d+) \| (.+?) \| (\d+) \|$'
ROWS = re.findall(ROW, TEXT, re.MULTILINE)
QUIZ_ROWS = re.findall(
    r'^\| \[(.+?)\]\((.+?)\) \| .+? \| .+? \| (\d+) \|  \|  \|$', TEXT, re.MULTILINE
)


def test_each_lesson_has_its_row_with_title_exercises_and_points():
    course = Course()
    names = course.assignments()
    assert [link for _, link, *_ in ROWS] == [f'{name}/{name}.ipynb' for name in names]
    for row, name in zip(ROWS, names, strict=True):
        title, _, abilities, needs, minutes, exercises, points = row
        opening = course.release(name).cells[0].source
        assert opening.startswith(f'# {title}\n')
        assert abilities.split('; ')[0] in opening
        promised = re.findall(r'^\| `(\w+)` \| (\d+) \|$', opening, re.MULTILINE)
        assert re.findall(r'`(\w+)`', exercises) == [exercise for exercise, _ in promised]
        assert f'| {needs} | about {minutes} minutes |\n' in f'{opening}\n'
        assert int(points) == sum(int(worth) for _, worth in promised)
    assert f'| **{sum(int(row[-1]) for row in ROWS)}** |' in TEXT
    minutes = [int(row[-3]) for row in ROWS] + [int(row[-1]) for row in QUIZ_ROWS]
    assert f'| **{sum(minutes)}** |' in TEXT


def test_each_quiz_has_its_row_after_the_lessons_of_its_half():
    links = [link for _, link, *_ in ROWS]
    assert [link for _, link, *_ in QUIZ_ROWS] == ['quiz_topics.ipynb', 'quiz_services.ipynb']
    order = re.findall(r'^\| \[.+?\]\((.+?)\)', TEXT, re.MULTILINE)
    seven = order.index('07_common_errors/07_common_errors.ipynb')
    assert order[seven + 1] == 'quiz_topics.ipynb'
    assert order[-1] == 'quiz_services.ipynb'
    assert [link for link in order if 'quiz' not in link] == links


def test_the_metadata_of_the_index_says_how_each_exercise_is_checked():
    contents = INDEX.metadata.my_robot_basics.contents
    assert [each.lesson for each in contents] == Course().assignments()
    kinds = {each.name: each.checked for lesson in contents for each in lesson.exercises}
    assert kinds['five_hz'] == 'here'
    assert kinds['explain_counts'] == 'by hand'
    listed = re.findall(r'`(\w+)`', ' '.join(row[-2] for row in ROWS))
    assert [*kinds] == listed


def test_an_exercise_without_visible_checks_is_marked_as_checked_at_grading():
    def kinds():
        return [each['checked'] for each in progress_row(TOY, lesson)['exercises']]

    lesson = toy_lesson()
    assert set(kinds()) == {'here', 'by hand'}
    for cell in lesson.cells:
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('grade'):
            cell.source = f'### BEGIN HIDDEN TESTS\n{cell.source}\n### END HIDDEN TESTS'
    assert set(kinds()) == {'at grading', 'by hand'}


@pytest.mark.parametrize('link', re.findall(r'\]\((.+?)\)', TEXT))
def test_the_links_of_the_index_lead_to_existing_files(link):
    assert (ROOT / 'notebooks' / link).is_file()


def test_lessons_mark_the_place_of_answers_in_the_words_of_the_index():
    released = ''.join(path.read_text() for path in ROOT.glob('notebooks/[0-9]*/*.ipynb'))
    stubs = re.findall(r'`(YOUR [A-Z ]+)`', TEXT)
    assert len(stubs) == 2
    assert [stub for stub in stubs if stub not in released] == []


@pytest.mark.parametrize('page', ['terms.md', 'what_next.md'])
def test_the_index_links_to_each_further_page_and_is_linked_back(page):
    assert f']({page})' in TEXT
    assert '](index.ipynb)' in (ROOT / 'notebooks' / page).read_text()


def test_long_items_stand_in_one_line_and_break_no_table(tmp_path):
    course = make_course(tmp_path)
    lesson = toy_lesson()
    lesson.cells[0].source = (
        '# 0 · A toy\n\n**You will be able to**\n\n1. double a number,\n   whatever it is,\n'
        '2. say what |x| is.\n\n| exercise | points |\n|---|---|\n'
    )
    write_source(course, lesson)
    contents = make_index(course).cells[0].source
    row = next(line for line in contents.splitlines() if TOY in line)
    assert r'| double a number, whatever it is; say what \|x\| is |' in row


def test_only_existing_pages_are_released_and_linked(tmp_path):
    course = make_course(tmp_path)
    write_source(course, toy_lesson())
    (course.root / 'solutions/what_next.md').write_text('# What next\n')
    built = tmp_path / 'built'
    built.mkdir()
    write_pages(course, built, metadata={})
    assert sorted(path.name for path in built.iterdir()) == ['index.ipynb', 'what_next.md']
    text = nbformat.read(built / 'index.ipynb', as_version=4).cells[-1].source
    assert '](what_next.md)' in text
    assert 'terms.md' not in text
