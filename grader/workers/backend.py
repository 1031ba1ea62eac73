"""What grades: the worker processes of this machine, or those of a cluster."""

from concurrent.futures import Future
from typing import Protocol, Self

from nbformat import NotebookNode

from grader.judging.task import GradingTask, Result
from grader.notebook.restore import KEY, AssignmentTemplate, restore
from grader.notebook.submission import Submission
from grader.storage.pipeline import unanswered


class Backend(Protocol):
    """Takes tasks inside its `with`; what is not done when that is left is called off."""

    capacity: int
    """How many submissions it works on at a time."""

    def __enter__(self) -> Self:
        """Begin to take tasks."""
        ...

    def __exit__(self, *exception: object) -> None:
        """End what still runs."""
        ...

    def begin(self) -> None:
        """Prepare for a task, of which it is known that there is going to be one."""
        ...

    def require_isolation(self, *, trust_students: bool) -> bool:
        """Return whether student code runs in a sandbox; raises CourseError where it must."""
        ...

    def submit(self, task: GradingTask) -> 'Future[Result]':
        """Grade a task as soon as there is room. The future raises TaskFailed for no result."""
        ...


def submit_for_grading(
    submission: Submission,
    template: AssignmentTemplate,
    *,
    backend: Backend,
    seed: str,
    trust_students: bool,
) -> 'Future[Result]':
    """Restore a submission from a prepared template, and have it run with the inputs of a seed."""
    if submission.problem:
        nothing: Future[Result] = Future()
        nothing.set_result(Result(unanswered(template, submission.problem), 0.0))
        return nothing
    return backend.submit(
        GradingTask(
            notebook=_restored(submission, template),
            files={name: path.read_bytes() for name, path in submission.files.items()},
            seed=seed,
            trust_students=trust_students,
        )
    )


def _restored(submission: Submission, template: AssignmentTemplate) -> NotebookNode:
    assert submission.notebook is not None  # else it has a problem
    notebook = restore(submission.notebook, template).notebook
    notebook.metadata[KEY].notes += submission.notes
    return notebook
