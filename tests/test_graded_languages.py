"""Grading ignores languages: an answer earns the same in each edition of its lesson."""

import csv
import shutil
from copy import deepcopy
from functools import cache

import nbformat
import pytest
from course_maker import TOY, answered, executed, released_course, submit
from my_robot_basics.language.catalogues import languages
from my_robot_basics.language.speaking import LANGUAGE
from nbformat import NotebookNode
from package_changes import write
from sample_class import EXPECTED, PATHS, assignment_of, package_of
from stand_in import stand_in

from grader.authoring.editions import is_translated
from grader.course import ROOT, Course
from grader.export.scores import write_scores
from grader.grade import grade_all
from grader.judging.execute import Execution
from grader.notebook.reading import read_notebook
from grader.notebook.restore import KEY, make_template, restore
from grader.report.feedback import write_feedback
from grader.storage.records import records, verdicts
from grader.storage.submitted import find_submissions

EDITIONS = languages(ROOT / 'locale')
ASSIGNMENTS = sorted({*map(assignment_of, PATHS.values())})
UNREADABLE = '03_publisher-zero-not_json'
"""A sample that is no notebook in any language."""


@cache
def texts(language, assignment):
    """Return the text cells of a lesson in a language, by id."""
    path = ROOT / 'notebooks' / language / assignment / f'{assignment}.ipynb'
    cells = nbformat.read(path, as_version=4).cells
    return {cell.id: cell.source for cell in cells if is_translated(cell)}


@cache
def template(assignment):
    course = Course()
    return make_template(course.source(assignment), course.release(assignment))


def in_edition(language, submitted, assignment):
    """Return what the same student would have submitted of another edition."""
    other = deepcopy(submitted)
    known = texts(language, assignment)
    for cell in other.cells:
        if is_translated(cell):
            cell.source = known.get(cell.get('id'), cell.source)
    other.metadata.setdefault(KEY, NotebookNode())[LANGUAGE] = language
    return other


@pytest.mark.parametrize('assignment', ASSIGNMENTS)
@pytest.mark.parametrize('language', EDITIONS)
def test_a_sample_is_restored_to_the_same_notebook_in_each_edition(language, assignment):
    names = [name for name, path in PATHS.items() if assignment_of(path) == assignment]
    differ = 0
    for name in (each for each in names if '-zero-' not in each):  # of no lesson, or of another
        english = read_notebook(PATHS[name])
        other = in_edition(language, english, assignment)
        differ += [cell.source for cell in english.cells] != [cell.source for cell in other.cells]
        ours, theirs = (restore(each, template(assignment)) for each in (english, other))
        said = theirs.notebook.metadata[KEY].pop(LANGUAGE)
        assert said == language
        assert theirs == ours, name  # what is graded, and what is noted of it
    assert differ


@pytest.mark.slow  # what is graded is the same, as the test above sees
@pytest.mark.starts
@pytest.mark.timeout(1800)
@pytest.mark.parametrize('assignment', ASSIGNMENTS)
@pytest.mark.parametrize('language', EDITIONS)
def test_the_whole_sample_class_earns_the_same_in_another_edition(language, assignment, tmp_path):
    course = Course(gradebook=tmp_path / 'gradebook')
    paths = {name: path for name, path in PATHS.items() if assignment_of(path) == assignment}
    for name, path in paths.items():
        folder = course.folder('submitted', name, assignment)
        folder.mkdir(parents=True)
        target = folder / f'{assignment}.ipynb'
        shutil.copyfile(path, target)
        write(package_of(name), folder)
        if name != UNREADABLE:
            nbformat.write(in_edition(language, read_notebook(path), assignment), target)
    rows = {row.student_id: row for row in grade_all(course, find_submissions(course))}
    assert set(rows) == set(paths)
    earned = {(each.student_id, each.grade_id): each.score for each in records(course)}
    wrong = {}
    for name in paths:
        found = verdicts(course, name, assignment)
        for grade_id, (score, *words) in EXPECTED[name].items():
            verdict = found.get(grade_id, {})
            said = ' | '.join([verdict.get('reason', ''), *verdict.get('notes', [])])
            if earned[name, grade_id] != score or any(word not in said for word in words):
                wrong[name, grade_id] = (earned[name, grade_id], score, said)
        points = sum(score or 0.0 for score, *_ in EXPECTED[name].values())
        if rows[name].stored.score != points:
            wrong[name] = (rows[name].stored.score, points)
    assert wrong == {}


# --- a class of several languages ----------------------------------------------------------------

RIGHT = 'def double(x):\n    """返回 x 的两倍。"""\n    return 2 * x  # 加上自己'
WRONG = 'def double(x):\n    return x + 1'


@pytest.fixture
def course(tmp_path, monkeypatch):
    """A small course; no answer is run, the verdict is made from its text."""

    async def look(notebook, **_):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
        notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
        return Execution(notebook=notebook, verdicts=(), notes=())

    stand_in(look, monkeypatch)
    return released_course(tmp_path)


def of(course, answer, language=''):
    notebook = answered(course, answer)
    if language:
        notebook.metadata.setdefault(KEY, NotebookNode())[LANGUAGE] = language
    return notebook


def graded(course):
    return {
        row.student_id: (row.stored.score, row.reason)
        for row in grade_all(course, find_submissions(course))
    }


def page(course, student):
    return (course.folder('feedback', student, TOY) / f'{TOY}.html').read_text(encoding='utf-8')


def test_students_of_all_languages_are_graded_alike_and_read_their_own_language(course):
    for number, answer in enumerate((RIGHT, WRONG)):
        submit(course, f'ada{number}', of(course, answer))
        submit(course, f'小明{number}', of(course, answer, 'zh_CN'))
    rows = graded(course)
    assert rows['小明0'][0] == rows['ada0'][0] == 3.0
    assert rows['小明1'] == rows['ada1']  # the report's words are the instructors'
    assert rows['小明1'][0] == 0.0
    assert rows['小明1'][1].startswith('expected 2, saw 3')
    write_feedback(course)
    assert '<html lang="en">' in page(course, 'ada1')
    assert '<html lang="zh-CN">' in page(course, '小明1')
    assert 'Feedback for ada1' in page(course, 'ada1')
    assert '给 小明1 的反馈' in page(course, '小明1')


def test_a_student_who_changes_the_language_keeps_the_grade(course):
    submit(course, 'ada', of(course, RIGHT))
    assert graded(course)['ada'][0] == 3.0
    submit(course, 'ada', of(course, RIGHT, 'zh_CN'))
    assert graded(course)['ada'][0] == 3.0
    write_feedback(course)
    assert '<html lang="zh-CN">' in page(course, 'ada')
    submit(course, 'ada', of(course, WRONG, 'zh_CN'))
    assert graded(course)['ada'][0] == 0.0
    submit(course, 'ada', of(course, RIGHT))
    assert graded(course)['ada'][0] == 3.0
    write_feedback(course)
    assert '<html lang="en">' in page(course, 'ada')


def test_scores_are_in_a_table_that_a_spreadsheet_opens_with_the_right_characters(course):
    submit(course, '小明', of(course, WRONG, 'zh_CN'))
    graded(course)
    path = write_scores(course)
    assert path.read_bytes().startswith(b'\xef\xbb\xbf')  # Excel guesses another encoding without
    with path.open(encoding='utf-8-sig', newline='') as file:
        assert {row['student_id'] for row in csv.DictReader(file)} == {'小明'}
