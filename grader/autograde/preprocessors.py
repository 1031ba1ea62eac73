"""Our two passes among nbgrader's: restore a submission, and run it in two rooms."""

import atexit
from functools import cache

import nbformat
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode
from traitlets import Bool

from grader.course import Course
from grader.judging.task import GradingTask
from grader.kernels.isolation import require_isolation
from grader.notebook.restore import KEY, restore
from grader.notebook.submission import Submission, read_submission
from grader.storage.seeds import seeds
from grader.workers.workers import Workers


def submission_of(resources: dict) -> Submission:
    """Return what nbgrader is about to grade, read anew from what was handed in.

    Not from autograded/: nbgrader puts the instructor's files, a solved package, over those there.
    """
    course, at = Course.of_nbgrader(resources), resources['nbgrader']
    return read_submission(
        course.folder('submitted', at['student'], at['assignment']),
        student_id=at['student'],
        assignment=at['assignment'],
        packages=course.packages(at['assignment']),
    )


class RestoreSubmission(Preprocessor):
    """Put a submitted notebook back into the shape of its source."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the restored notebook; the submitted file is not touched.

        It is read anew, as strangers' files are: what nbgrader has read may hold anything.
        """
        at = resources['nbgrader']
        submission = submission_of(resources)
        restored = restore(
            submission.notebook or nbformat.v4.new_notebook(),
            Course.of_nbgrader(resources).template(at['assignment']),
        ).notebook
        restored.metadata[KEY].notes += submission.notes
        if submission.problem:
            restored.metadata[KEY] = {'notes': [submission.problem], 'problem': submission.problem}
        return restored, resources


class ExecuteRooms(Preprocessor):
    """Run student cells in one kernel and grade cells in another, in nbgrader's Execute's place.

    That is done by a worker process, as for `./course grade`: this one holds the gradebook.
    nbgrader's resource path is not used as a working directory: that folder holds the tests.
    """

    enabled = True
    trust_students = Bool(
        False, help='Grade even where this machine has no sandbox for student code.'
    ).tag(config=True)

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the executed notebook with a verdict in each grade cell.

        Raises CourseError where there is no sandbox, and TaskFailed where there is no verdict.
        """
        at = resources['nbgrader']
        require_isolation(trust_students=self.trust_students)
        submission = submission_of(resources)
        task = GradingTask(
            notebook=nb,
            files={name: path.read_bytes() for name, path in submission.files.items()},
            seed=seeds(Course.of_nbgrader(resources), at['assignment'])(submission),
            trust_students=self.trust_students,
        )
        return _workers().submit(task).result().notebook, resources


@cache
def _workers() -> Workers:
    """Return the one that grades for this process, as long as this one lives."""
    workers = Workers(1, in_flight=1).__enter__()
    atexit.register(workers.__exit__)
    return workers
