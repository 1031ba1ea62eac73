"""Our two preprocessors for nbgrader: restore a submission, and run it in two rooms."""

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
    """Return the submission that nbgrader is grading, read again from submitted/.

    It can't be read from autograded/: there, nbgrader overwrites the student's package with the
    instructor's solved one.
    """
    course, at = Course.of_nbgrader(resources), resources['nbgrader']
    return read_submission(
        course.folder('submitted', at['student'], at['assignment']),
        student_id=at['student'],
        assignment=at['assignment'],
        packages=course.packages(at['assignment']),
    )


class RestoreSubmission(Preprocessor):
    """Restore a submitted notebook from its source."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the restored notebook; the submitted file is not changed.

        The file is read again, with limits: the notebook that nbgrader has read is not checked.
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
    """Run student cells in one kernel and grade cells in another; replaces nbgrader's Execute.

    A worker process does that, as for `./course grade`, because this process has the gradebook.
    nbgrader's resource path is not used as working directory: that folder contains the tests.
    """

    enabled = True
    trust_students = Bool(
        False, help='Grade even where this machine has no sandbox for student code.'
    ).tag(config=True)

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the executed notebook with a verdict in each grade cell.

        Raises CourseError if there is no sandbox, and TaskFailed if there is no verdict.
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
    """Return this process's worker, which ends with this process."""
    workers = Workers(1, in_flight=1).__enter__()
    atexit.register(workers.__exit__)
    return workers
