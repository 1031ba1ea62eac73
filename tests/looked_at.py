"""A course whose answers are compared as text instead of being run."""

from course_maker import TOY, executed, released_course
from nbgrader.api import Gradebook
from stand_in import stand_in

from grader.grade import grade_all
from grader.judging.execute import Execution
from grader.storage.submitted import find_submissions

RIGHT = 'def double(x):\n    return 2 * x'
WRONG = 'def double(x):\n    return x + 1'


def looked_at_course(folder, monkeypatch, looked):
    """Return a released course; each answer that would be run is appended to `looked`."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        looked.append(answer)
        reason = '?' if 'no room' in answer else '' if '2 * x' in answer else 'count again'
        if 'harder' in ''.join(cell.source for cell in notebook.cells):
            reason = reason or 'not good enough'
        reasons = {'double-check': '', 'double-hidden': reason}
        return Execution(notebook=executed(notebook, reasons), verdicts=(), notes=())

    stand_in(look, monkeypatch)
    return released_course(folder)


def rows_of(course, **options):
    return {row.student_id: row for row in grade_all(course, find_submissions(course), **options)}


def score_by_hand(course, student, points):
    with Gradebook(course.db_url) as book:
        grade = book.find_grade('explain', TOY, TOY, student)
        grade.manual_score, grade.needs_manual_grade = points, False
        book.db.commit()


def graded_path(course, student):
    return course.folder('autograded', student, TOY) / f'{TOY}.ipynb'
