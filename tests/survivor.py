"""Grade a toy class, without rooms, in a process that may be killed at any moment."""

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from course_maker import executed
from stand_in import stand_in as stand_in_for_rooms

from grader import grading
from grader.__main__ import main
from grader.course import Course
from grader.judging.execute import Execution
from grader.storage import gradebook, reuse
from grader.storage.save_grades import SaveGrades

PARTS = ('all', 'storing', 'scores')
"""Parts of a run: all of it, storing submissions, and, within that, writing their scores."""


def kill() -> None:
    """Kill this process at once."""
    os.kill(os.getpid(), signal.SIGKILL)


def run(
    root: str,
    gradebook_at: str,
    log: str,
    kill_at: int = 0,
    part: str = 'all',
    strike: Callable[[], object] = kill,
    said: str = os.devnull,
) -> None:
    """Run `./course grade`; kill it at the `kill_at`-th call of a function of Python or C.

    Only calls in a `part` of the run are counted. `log` gets what is judged, and at the end the
    status and the number of calls in each part; `said` gets what is printed. `strike` replaces
    the kill by another disturbance.
    """
    calls, within = dict.fromkeys(PARTS, 0), dict.fromkeys(PARTS, 0) | {'all': 1}

    def count(frame: object, event: str, what: object) -> None:
        if event in ('call', 'c_call'):
            for name in PARTS:
                if within[name]:
                    calls[name] += 1
            if kill_at and calls[part] == kill_at:
                calls[part] += 1  # so that it happens only once
                sys.setprofile(None)
                strike()
                sys.setprofile(count)

    def counted(name: str, work: Callable) -> Callable:
        def wrapper(*args: object) -> object:
            within[name] += 1
            try:
                return work(*args)
            finally:
                within[name] -= 1

        return wrapper

    stand_in(Path(log))
    grading.store = counted('storing', grading.store)
    gradebook._store_all = counted('storing', gradebook._store_all)
    SaveGrades.preprocess = counted('scores', SaveGrades.preprocess)
    sys.stdout = sys.stderr = open(said, 'w', encoding='utf-8')  # noqa: SIM115 - open to the end
    sys.setprofile(count)
    status = main(['grade'], course=Course(root=Path(root), gradebook=Path(gradebook_at)))
    sys.setprofile(None)
    with open(log, 'a', encoding='utf-8') as file:
        print(status, *(calls[name] for name in PARTS), file=file)


def stand_in(log: Path) -> None:
    """Replace the rooms by a look at the answer's text."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        with log.open('a', encoding='utf-8') as file:
            file.write(f'judged {answer.splitlines()[0].removeprefix("# ")}\n')
        reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
        notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
        notebook.metadata['my_robot_basics']['seed'] = seed
        return Execution(notebook=notebook, verdicts=(), notes=())

    stand_in_for_rooms(look, pytest.MonkeyPatch())
    reuse.software_hash = lambda: 'the same code'  # hashing all that is installed takes long
