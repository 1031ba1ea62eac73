"""Which database queries storing skips because the answer is known, and which it makes anyway."""

import copy
import sqlite3
from contextlib import contextmanager

import nbformat
import pytest
from course_maker import TOY, answered, executed, released_course, submit
from nbconvert.exporters import Exporter
from nbgrader.api import Gradebook, MissingEntry
from nbgrader.nbgraderformat import MetadataValidator, ValidationError
from sqlalchemy import event, text
from sqlalchemy.engine import Engine
from stored_grades import RIGHT, grade
from traitlets.config import Config

from grader.authoring.release_passes import CODE_STUB, PASSES
from grader.notebook.submission import read_submission
from grader.storage.cell_metadata import CheckMetadataOnce
from grader.storage.database import open_database, share_engine
from grader.storage.gradebook import store
from grader.storage.pipeline import (
    apply_preprocessors,
    make_sanitized_template,
    make_unanswered,
    resources_of,
)
from grader.storage.submission_rows import SubmissionRows

MOST_QUESTIONS = 10
"""Most database queries for storing a known submission, however many cells it has."""


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('storing'))


@contextmanager
def watched(what):
    """Collect what SQLAlchemy does meanwhile."""
    seen = []

    def note(*arguments):
        seen.append(arguments)

    event.listen(Engine, what, note)
    try:
        yield seen
    finally:
        event.remove(Engine, what, note)


def graded_toy(course, student, **reasons):
    submit(course, student, answered(course, RIGHT))
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    return submission, executed(
        make_unanswered(make_sanitized_template(course, TOY), 'why'), reasons
    )


def test_release_passes_do_the_same_as_in_nbconverts_exporter(course):
    passes = PASSES[: PASSES.index('nbgrader.preprocessors.SaveCells')]
    configured = {'Exporter': {'default_preprocessors': []}}
    configured |= {'ClearSolutions': {'code_stub': CODE_STUB}}
    exporter = Exporter(config=Config(configured))
    for each in passes:
        exporter.register_preprocessor(each)
    lesson, at = course.source(TOY), resources_of(course, TOY)
    before = copy.deepcopy(lesson)
    ours = [apply_preprocessors(passes, lesson, at) for _ in range(2)]
    assert ours[0] == ours[1]
    assert lesson == before
    assert ours[0] == exporter.from_notebook_node(lesson, at)[0] != lesson


def test_an_invalid_notebook_is_refused_before_anything_is_stored(course):
    submission, graded = graded_toy(course, 'mona')
    graded.cells[1].outputs = 'none'
    with pytest.raises(nbformat.ValidationError):
        store(course, submission, graded)
    with Gradebook(course.db_url) as book, pytest.raises(MissingEntry):
        book.find_student('mona')


def test_storing_takes_one_connection_and_few_database_queries(course):
    submission, graded = graded_toy(course, 'ada')
    with share_engine(course.db_url):
        store(course, submission, copy.deepcopy(graded))
        with watched('before_cursor_execute') as asked, watched('connect') as connections:
            store(course, submission, graded)
    assert 0 < len(asked) <= MOST_QUESTIONS
    assert len(connections) <= 1


def test_a_nested_connection_block_discards_uncommitted_changes(course):
    grade(course, 'bob', {})
    with open_database(course.db_url) as book:
        with open_database(course.db_url) as inner:
            assert inner is book
            inner.db.execute(text('update grade set auto_score = 7'))
        held = set(book.db.scalars(text('select auto_score from grade')))
        with sqlite3.connect(course.database, timeout=0) as other:  # nothing is locked
            other.execute('begin exclusive')
            other.rollback()
    assert 7 not in held
    with open_database(course.db_url) as another:
        assert another is not book


def test_rows_of_a_submission_are_found_as_by_nbgrader(course):
    grade(course, 'cleo', {}, explained='so')
    with open_database(course.db_url) as book:
        rows = SubmissionRows(book, book.find_submission(TOY, 'cleo'), TOY)
        for name in ('double-check', 'double-hidden', 'explain'):
            assert rows.find_grade(name) is book.find_grade(name, TOY, TOY, 'cleo')
        for name in ('double', 'explain'):
            assert rows.find_comment(name) is book.find_comment(name, TOY, TOY, 'cleo')
        for find in (rows.find_grade, rows.find_comment):
            with pytest.raises(MissingEntry):
                find('gone')


def test_valid_metadata_is_checked_once_and_invalid_metadata_each_time(course, monkeypatch):
    looked = []
    does = MetadataValidator.validate_nb
    monkeypatch.setattr(
        MetadataValidator, 'validate_nb', lambda self, nb: looked.append(1) or does(self, nb)
    )
    check, lesson = CheckMetadataOnce(), make_sanitized_template(course, TOY).notebook
    lesson.cells[4].metadata.nbgrader.grade_id = 'of-this-test'
    looked.clear()
    for _ in range(2):
        check.preprocess(lesson, {})
    lesson.cells.insert(1, nbformat.v4.new_markdown_cell("a student's own"))
    check.preprocess(lesson, {})
    assert len(looked) == 1
    for wrong in ({'grade_id': 'double-check'}, {'points': -1}, {'grade': 'perhaps'}):
        other = copy.deepcopy(lesson)
        other.cells[-1].metadata.nbgrader.update(wrong)
        for _ in range(2):
            with pytest.raises(ValidationError):
                check.preprocess(other, {})
    other = copy.deepcopy(lesson)
    other.cells[-1].cell_type = 'code'
    check.preprocess(other, {})
    assert len(looked) == 8
