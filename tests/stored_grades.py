"""Grades that are given without rooms, and stored as the grader stores them."""

from course_maker import TOY, answered, executed, submit

from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.registering import register

RIGHT = 'def double(x):\n    return 2 * x'


def grade(course, student, reasons, *, notebook=None, **answer):
    submit(course, student, notebook or answered(course, RIGHT, **answer))
    return store(course, *graded_with(course, student, reasons))


def graded_with(course, student, reasons=None):
    folder = course.folder('submitted', student, TOY)
    if not folder.exists():
        submit(course, student, answered(course, RIGHT))
    submission = read_submission(folder, student_id=student, assignment=TOY)
    register(course, TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    return submission, executed(sanitize_restored(course, TOY, restored), reasons or {})
