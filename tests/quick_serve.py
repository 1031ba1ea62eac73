"""`serve` without rooms, for tests: a look at the answer's text replaces running it."""

import asyncio
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, executed
from nbgrader.utils import notebook_hash
from stand_in import Here, stand_in

from grader.cli.stopping import stoppable
from grader.course import Course
from grader.grade import grade_all
from grader.grading import SubmissionOutcome
from grader.judging.execute import Execution
from grader.notebook.restore import KEY
from grader.serving.exchange import feedback_folder
from grader.serving.queue import FAILED, GRADED, REFUSED, WAITING, Arrival
from grader.serving.queue_file import open_queue_to_read
from grader.serving.serve import serve
from grader.serving.status import write_status_page
from grader.storage import reuse
from grader.storage.submitted import find_submissions

RIGHT = 'def double(x):\n    return 2 * x'
WRONG = 'def double(x):\n    return x + 1'


def exchange_in(folder: Path) -> Path:
    """Make a course's exchange; return its inbound folder, to which students submit."""
    for name in ('inbound', 'outbound', 'feedback'):
        (folder / 'exchange' / name).mkdir(parents=True)
    return folder / 'exchange' / 'inbound'


def hand_in(
    course: Course,
    inbound: Path,
    student: str,
    answer: str,
    *,
    number: int = 1,
    secret: str = 'aa',
) -> Path:
    """Put a submission there as `nbgrader submit` does; return its folder."""
    minutes, seconds = divmod(number, 60)
    folder = (
        inbound / f'{student}+{TOY}+2026-01-01 10:{minutes:02}:{seconds:02}.000000 UTC+x{number}'
    )
    folder.mkdir()
    (folder / f'{TOY}.ipynb').write_text(nbformat.writes(answered(course, answer)))
    (folder / 'timestamp.txt').write_text('2000-01-01 10:00:00.000000 UTC')
    (folder / 'submission_secret.txt').write_text(secret)
    folder.chmod(0o777)
    return folder


def put_there(course: Course, inbound: Path, student: str) -> Path:
    """Put a right submission into a folder of uploads, as a person does; return its folder."""
    folder = inbound / student / TOY
    folder.mkdir(parents=True)
    (folder / f'{TOY}.ipynb').write_text(nbformat.writes(answered(course, RIGHT)))
    return folder


def arrivals(course: Course) -> list[Arrival]:
    """Return the arrivals that were not replaced."""
    with open_queue_to_read(course.gradebook) as queue:
        return queue.find(WAITING, GRADED, REFUSED, FAILED)


def page_of(inbound: Path, secret: str) -> Path:
    """Return the path at which nbgrader looks for the feedback of a submission."""
    return inbound.parent / 'feedback' / f'{notebook_hash(secret=secret, notebook_id=TOY)}.html'


def command(course: Course, inbound: Path, *options: str) -> list[str]:
    """Return the command that serves a course in a separate process."""
    code = f'import sys; sys.path[:0] = {sys.path!r}; import quick_serve; quick_serve.main()'
    return [sys.executable, '-c', code, str(course.root), str(inbound), *options]


times: Counter[str] = Counter()
"""How often each answer with `busy` was graded."""


async def look(notebook, *, extra_files=(), seed='', trust_students=False):
    """Accept an answer with `2 * x`; with `# SECONDS s` in the answer, take that long.

    Do not decide the first N gradings of an answer with `busy N`.
    """
    answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
    await asyncio.sleep(float(answer.split(' s')[0].removeprefix('# ')) if ' s' in answer else 0.1)
    reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
    if 'busy' in answer:
        reason = '?' if times[answer] < int(answer.rpartition('busy ')[2]) else reason
        times[answer] += 1
    notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
    notebook.metadata[KEY]['seed'] = seed
    return Execution(notebook=notebook, verdicts=(), notes=())


@contextmanager
def without_rooms() -> Iterator[None]:
    """Replace the rooms by `look` in this process."""
    with pytest.MonkeyPatch.context() as patch:
        stand_in(look, patch)
        patch.setattr(Here, 'require_isolation', lambda self, **_: True)
        patch.setattr(reuse, 'software_hash', lambda: 'the same code')  # the real hash takes long
        yield


def grade_here(course: Course) -> list[SubmissionOutcome]:
    """Do what `./course grade` does."""
    with without_rooms():
        return list(grade_all(course, find_submissions(course)))


def serve_here(course: Course, inbound: Path, **options: object) -> list[str]:
    """Serve until nothing is left; return the lines that it printed."""
    said: list[str] = []
    options = {'once': True, 'say': said.append} | options
    with without_rooms():
        serve(
            course,
            inbound,
            backend=Here(),
            feedback=feedback_folder(inbound),
            changed=lambda queue: write_status_page(course, queue),
            **options,
        )
    return said


def main() -> None:
    """Serve until a signal ends it, or with --once until nothing is left."""
    with stoppable() as stop:
        try:
            serve_here(
                Course.at(Path(sys.argv[1])),
                Path(sys.argv[2]),
                once='--once' in sys.argv,
                say=lambda line: print(line, flush=True),
            )
        except KeyboardInterrupt:
            sys.exit(stop.status)
