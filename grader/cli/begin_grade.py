"""`./course grade`, before what takes long to import: the first worker starts meanwhile."""

import argparse

from grader.common.lean_imports import uncollected
from grader.course import Course
from grader.storage.submitted import find_submissions, is_new
from grader.workers.workers import Workers


def run_grade(course: Course, asked: argparse.Namespace) -> int:
    """Do what the verb does; return its exit status."""
    found = find_submissions(course, assignment=asked.assignment, student_id=asked.student)
    if asked.dask:
        from grader.cli import grade_verb

        return grade_verb.run_grade(course, asked, found)
    with Workers(asked.workers) as workers:
        if asked.force or asked.seed or any(is_new(course, each) for each in found):
            workers.begin()
        with uncollected():
            from grader.cli import grade_verb
        return grade_verb.run_grade(course, asked, found, workers)
