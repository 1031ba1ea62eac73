"""Grade a toy class in a process that may be ended at any moment, without rooms."""

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
"""Of a run: all of it, the storing of submissions, and of that the writing of their scores."""


def kill() -> None:
    """End this process at once."""
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
    """Run `./course grade`; be killed at the so manieth call of a function, Python's or C's.

    Counted are those in a part of the run. What is judged goes into `log`, and at the end the
    status and how many calls there were in each part; what is printed into `said`. Another
    `strike` hits something else.
    """
    calls, within = dict.fromkeys(PARTS, 0), dict.fromkeys(PARTS, 0) | {'all': 1}

    def count(frame: object, event: str, what: object) -> None:
        if event in ('call', 'c_call'):
            for name in PARTS:
                if within[name]:
                    calls[name] += 1
            if kill_at and calls[part] == kill_at:
                calls[part] += 1  # once
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
    gradebook._finish = counted('storing', gradebook._finish)
    SaveGrades.preprocess = counted('scores', SaveGrades.preprocess)
    sys.stdout = sys.stderr = open(said, 'w', encoding='utf-8')  # noqa: SIM115 - open to the end
    sys.setprofile(count)
    status = main(['grade'], course=Course(root=Path(root), gradebook=Path(gradebook_at)))
    sys.setprofile(None)
    with open(log, 'a', encoding='utf-8') as file:
        print(status, *(calls[name] for name in PARTS), file=file)


def stand_in(log: Path) -> None:
    """Let a look at the answer's text stand in for the rooms."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        with log.open('a', encoding='utf-8') as file:
            file.write(f'judged {answer.splitlines()[0].removeprefix("# ")}\n')
        reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
        notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
        notebook.metadata['my_robot_basics']['seed'] = seed
        return Execution(notebook=notebook, verdicts=(), notes=())

    stand_in_for_rooms(look, pytest.MonkeyPatch())
    reuse.machinery = lambda: 'the same code'  # hashing all that is installed takes long
