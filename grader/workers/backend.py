"""The interface of what grades: worker processes of this machine, or of a cluster."""

from concurrent.futures import Future
from typing import Protocol, Self

from nbformat import NotebookNode

from grader.judging.task import GradingTask, Result
from grader.notebook.restore import KEY, AssignmentTemplate, restore
from grader.notebook.submission import Submission
from grader.storage.pipeline import make_unanswered


class Backend(Protocol):
    """Takes tasks inside its `with`; unfinished tasks are cancelled at the end."""

    capacity: int
    """How many submissions it grades at a time."""

    def __enter__(self) -> Self:
        """Begin to take tasks."""
        ...

    def __exit__(self, *exception: object) -> None:
        """End what still runs."""
        ...

    def begin(self) -> None:
        """Prepare, because a task is going to be submitted."""
        ...

    def require_isolation(self, *, trust_students: bool) -> bool:
        """Return whether student code runs in a sandbox. Raises CourseError if it has to."""
        ...

    def submit(self, task: GradingTask) -> 'Future[Result]':
        """Grade a task when there is room. The future raises TaskFailed if there is no result."""
        ...


def submit_for_grading(
    submission: Submission,
    template: AssignmentTemplate,
    *,
    backend: Backend,
    seed: str,
    trust_students: bool,
) -> 'Future[Result]':
    """Restore a submission from a prepared template; have it run with the inputs of a seed."""
    if submission.problem:
        nothing: Future[Result] = Future()
        nothing.set_result(Result(make_unanswered(template, submission.problem), 0.0))
        return nothing
    return backend.submit(
        GradingTask(
            notebook=_restore(submission, template),
            files={name: path.read_bytes() for name, path in submission.files.items()},
            seed=seed,
            trust_students=trust_students,
        )
    )


def _restore(submission: Submission, template: AssignmentTemplate) -> NotebookNode:
    assert submission.notebook is not None  # a submission without one has a problem
    notebook = restore(submission.notebook, template).notebook
    notebook.metadata[KEY].notes += submission.notes
    return notebook
