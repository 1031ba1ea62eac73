"""What grades: the worker processes of this machine, or those of a cluster."""

from concurrent.futures import Future
from typing import Protocol, Self

from nbformat import NotebookNode

from grader.judging.task import Result, Task
from grader.notebook.restore import KEY, Master, heal
from grader.notebook.submission import Submission
from grader.storage.pipeline import unanswered


class Crew(Protocol):
    """Takes tasks inside its `with`; what is not done when that is left is called off."""

    room: int
    """How many submissions it works on at a time."""

    def __enter__(self) -> Self:
        """Begin to take tasks."""
        ...

    def __exit__(self, *exception: object) -> None:
        """End what still runs."""
        ...

    def isolated(self, *, trust_students: bool) -> bool:
        """Return whether student code runs in a sandbox; raises CourseError where it must."""
        ...

    def submit(self, task: Task) -> 'Future[Result]':
        """Grade a task as soon as there is room. The future raises TaskFailed for no result."""
        ...


def judged(
    submission: Submission, master: Master, *, crew: Crew, seed: str, trust_students: bool
) -> 'Future[Result]':
    """Heal one submission from a prepared master, and have it run with the inputs of a seed."""
    if submission.problem:
        nothing: Future[Result] = Future()
        nothing.set_result(Result(unanswered(master, submission.problem), 0.0))
        return nothing
    return crew.submit(
        Task(
            notebook=_healed(submission, master),
            files={path.name: path.read_bytes() for path in submission.extra_files},
            seed=seed,
            trust_students=trust_students,
        )
    )


def _healed(submission: Submission, master: Master) -> NotebookNode:
    notebook = heal(submission.notebook, master).notebook
    notebook.metadata[KEY].notes += submission.notes
    return notebook
