"""Grade a toy class in a process that may be ended at any moment, without rooms."""

import os
import signal
import sys
from pathlib import Path

import pytest
from course_maker import executed
from stand_in import stand_in as stand_in_for_rooms

from grader import reuse
from grader.__main__ import main
from grader.course import Course
from grader.execute import Execution


def run(root: str, gradebook: str, log: str, kill_at: int = 0) -> None:
    """Run `./course grade`; be killed at the so manieth call of a function, Python's or C's.

    What is judged goes into `log`, and at the end how many calls there were.
    """
    calls = 0

    def count(frame: object, event: str, what: object) -> None:
        nonlocal calls
        if event in ('call', 'c_call'):
            calls += 1
            if calls == kill_at:
                os.kill(os.getpid(), signal.SIGKILL)

    stand_in(Path(log))
    sys.stdout = sys.stderr = open(os.devnull, 'w')  # noqa: SIM115 - open to the end
    sys.setprofile(count)
    status = main(['grade'], course=Course(root=Path(root), gradebook=Path(gradebook)))
    sys.setprofile(None)
    with open(log, 'a', encoding='utf-8') as file:
        file.write(f'{status} {calls}\n')


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
