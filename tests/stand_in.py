"""A backend without rooms: a function's verdicts replace running a notebook."""

from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from typing import Any

import pytest
from nbformat import NotebookNode

from grader import grade, replay
from grader.autograde import preprocessors
from grader.cli import begin_grade
from grader.common.pool import Pool
from grader.judging import task
from grader.judging.execute import Execution
from grader.kernels.isolation import require_isolation
from grader.notebook.restore import KEY


class Here:
    """Does in this process what workers do in theirs."""

    capacity = 4

    def __init__(self, number=None):
        self._pools = []

    def __enter__(self):
        self._pools.append(Pool(self.capacity).__enter__())
        return self

    def __exit__(self, *exception):
        self._pools.pop().__exit__(*exception)

    def begin(self):
        pass

    def require_isolation(self, *, trust_students):
        return require_isolation(trust_students=trust_students)

    def submit(self, work):
        return self._pools[-1].submit(self._graded, work)

    async def _graded(self, work):
        return task.unpack(await task.run_packed(task.pack(work)), work)


def stand_in(look: Callable[..., Awaitable[Execution]], patch: pytest.MonkeyPatch) -> None:
    """Replace `grader.judging.execute.execute_exercises` by `look`, in this process."""

    async def looked(notebook: NotebookNode, **options: Any) -> Execution:
        execution = await look(notebook, **options)
        ours = execution.notebook.metadata.setdefault(KEY, NotebookNode(notes=[]))
        ours.setdefault('seed', options.get('seed', ''))
        return execution

    patch.setattr(task, 'execute_exercises', looked)
    for module in (begin_grade, grade, replay):
        patch.setattr(module, 'Workers', Here)


def note_tasks(patch: pytest.MonkeyPatch, judge: Callable[[NotebookNode], NotebookNode]) -> list:
    """Return a list of the tasks that nbgrader's preprocessors submit; `judge` makes results."""
    seen: list[task.GradingTask] = []

    class Noting:
        def submit(self, work: task.GradingTask) -> Future:
            seen.append(work)
            done: Future = Future()
            done.set_result(task.Result(judge(work.notebook), 1.0))
            return done

    patch.setattr(preprocessors, '_workers', Noting)
    return seen
