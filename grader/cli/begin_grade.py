"""The beginning of `./course grade`: the first worker starts before the slow imports."""

import argparse

from grader.common.errors import CourseError
from grader.common.lean_imports import pause_garbage_collection
from grader.course import Course
from grader.storage.submitted import find_submissions, is_new
from grader.workers.backend import Backend
from grader.workers.workers import Workers


def start_workers_and_grade(course: Course, asked: argparse.Namespace) -> int:
    """Start workers if anything is new, then grade and report; return the exit status."""
    cluster = _cluster(asked)
    found = find_submissions(course, assignment=asked.assignment, student_id=asked.student)
    if cluster:
        from grader.cli import grade_verb

        return grade_verb.grade_and_report(course, asked, found, cluster)
    with Workers(asked.workers) as workers:
        if asked.force or asked.seed or any(is_new(course, each) for each in found):
            workers.begin()
        with pause_garbage_collection():
            from grader.cli import grade_verb
        return grade_verb.grade_and_report(course, asked, found, workers)


def _cluster(asked: argparse.Namespace) -> Backend | None:
    """Return the cluster to grade on, or None. Raises CourseError for options that don't fit."""
    from grader.workers.dask_client import Certificates

    certificates = Certificates(asked.tls_ca_file, asked.tls_cert, asked.tls_key)
    if not asked.dask:
        if certificates != Certificates():
            raise CourseError('--tls-ca-file, --tls-cert and --tls-key go with --dask tls://…')
        return None
    if asked.trust_students:
        raise CourseError(
            '--trust-students and --dask do not go together: a worker without a sandbox would '
            'run what students wrote with the rights of all the cluster'
        )
    from grader.workers.dask_backend import Cluster

    return Cluster(asked.dask, certificates)
