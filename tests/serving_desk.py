"""A `serve` without rooms, for tests: what an answer says stands in for running it."""

import asyncio
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from course_maker import executed
from stand_in import Here, stand_in

from grader.cli.stopping import stoppable
from grader.course import Course
from grader.grade import grade_all
from grader.grading import SubmissionOutcome
from grader.judging.execute import Execution
from grader.notebook.restore import KEY
from grader.serving.exchange import feedback_folder
from grader.serving.serve import serve
from grader.serving.status import write_status_page
from grader.storage import reuse
from grader.storage.submitted import find_submissions


def command(course: Course, inbound: Path, *options: str) -> list[str]:
    """Return the command that serves a course in a process of its own."""
    code = f'import sys; sys.path[:0] = {sys.path!r}; import serving_desk; serving_desk.main()'
    return [sys.executable, '-c', code, str(course.root), str(inbound), *options]


async def look(notebook, *, extra_files=(), seed='', trust_students=False):
    """Say that a doubled number is right; `# SECONDS s` in the answer takes so long."""
    answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
    await asyncio.sleep(float(answer.split(' s')[0].removeprefix('# ')) if ' s' in answer else 0.1)
    reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
    notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
    notebook.metadata[KEY]['seed'] = seed
    return Execution(notebook=notebook, verdicts=(), notes=())


@contextmanager
def stood_in() -> Iterator[None]:
    """Let a look at the answer stand in for rooms, whoever grades."""
    with pytest.MonkeyPatch.context() as patch:
        stand_in(look, patch)
        patch.setattr(Here, 'require_isolation', lambda self, **_: True)
        patch.setattr(reuse, 'machinery', lambda: 'the same code')  # hashing it takes long
        yield


def grade_here(course: Course) -> list[SubmissionOutcome]:
    """Do what `./course grade` does."""
    with stood_in():
        return list(grade_all(course, find_submissions(course)))


def serve_here(course: Course, inbound: Path, **options: object) -> list[str]:
    """Serve until nothing is left; return what it said."""
    said: list[str] = []
    options = {'once': True, 'say': said.append} | options
    with stood_in():
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
