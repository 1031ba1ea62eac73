"""Shared by benchmarks of whole classes: a temporary gradebook, and commands that are watched.

    .venv/bin/python tests/benchmarks/measuring.py GRADEBOOK VERB ...

is `./course VERB ...` with another gradebook; the last line on stderr says how many seconds
storing took.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import psutil

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / 'tests'), str(ROOT / 'tests/benchmarks')]

from memory import peak_of

from grader import grading
from grader.__main__ import main
from grader.course import Course

ROW = r'^student_\d+ '
"""Matches the line of a synthetic student in the output of `./course grade`."""
STORED = re.compile(r'^seconds in the database: ([\d.]+)$', re.MULTILINE)


@dataclass
class Watched:
    """A command that has ended, by itself or killed."""

    status: int = 0
    seconds: float = 0.0
    done_at: list[float] = field(default_factory=list)
    """When each submission was done, in seconds since the start."""
    peak_bytes: int = 0
    """Peak memory (PSS, so shared pages count once) of the command and all its processes."""
    said: str = ''
    """Its output on stdout and stderr."""

    @property
    def database_sec(self) -> float:
        """Return how many seconds storing took."""
        return float(STORED.findall(self.said)[-1])

    @property
    def per_minute_warm(self) -> float:
        """Return the submissions per minute, without the first third."""
        first = len(self.done_at) // 3
        return 60 * (len(self.done_at) - 1 - first) / (self.done_at[-1] - self.done_at[first])


def new_course(name: str) -> Course:
    """Return the course with an empty gradebook in a temporary folder, which is kept."""
    return Course(gradebook=Path(tempfile.mkdtemp(prefix=f'{name}-'), 'gradebook'))


def course_command(course: Course, *arguments: object) -> list[str]:
    """Return the command for `./course ...` with this gradebook."""
    return [sys.executable, '-P', __file__, str(course.gradebook), *map(str, arguments)]


def watch(
    command: Sequence[str],
    *,
    done: str,
    cwd: Path = ROOT,
    meanwhile: Mapping[int, Callable[[psutil.Process], None]] = MappingProxyType({}),
) -> Watched:
    """Run a command; each output line that matches `done` counts as a finished submission.

    `meanwhile` has functions that are called with the process after that many submissions.
    """
    watched, lines = Watched(), []
    began = time.perf_counter()
    process = subprocess.Popen(
        command,
        cwd=cwd,
        # as in an activated virtual environment
        env=os.environ | {'PATH': f'{Path(sys.executable).parent}:{os.environ["PATH"]}'},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors='replace',
    )
    with _ended_with_us(process), peak_of(process.pid) as peak:
        for line in process.stdout:
            lines.append(line)
            if re.search(done, line):
                watched.done_at.append(time.perf_counter() - began)
                if act := meanwhile.get(len(watched.done_at)):
                    act(psutil.Process(process.pid))
        watched.status = process.wait()
    watched.seconds = time.perf_counter() - began
    watched.peak_bytes = peak[0]
    watched.said = ''.join(lines)
    return watched


def kill_a_worker(run: psutil.Process) -> None:
    """Kill one of a run's worker processes, as Linux's OOM killer would."""
    workers = [each for each in run.children() if 'grader.workers.begin_worker' in each.cmdline()]
    workers[0].kill()


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Print a table with right-aligned columns."""
    texts = [list(heads), *([_text(field) for field in row] for row in rows)]
    widths = [max(len(row[i]) for row in texts) for i in range(len(heads))]
    for row in texts:
        first, *others = (
            field.ljust(width) if i == 0 else field.rjust(width)
            for i, (field, width) in enumerate(zip(row, widths, strict=True))
        )
        print('  '.join([first, *others]).rstrip(), flush=True)


def minutes(seconds: float) -> str:
    """Return a duration in minutes and seconds, as text."""
    return f'{seconds // 60:.0f} min {seconds % 60:.0f} s'


def _text(field: object) -> str:
    return f'{field:,.1f}' if isinstance(field, float) else str(field)


@contextmanager
def _ended_with_us(process: subprocess.Popen) -> Iterator[None]:
    try:
        yield
    except BaseException:
        process.terminate()  # it ends all processes that it runs
        process.wait()
        raise


def _timed(work: Callable, spent: list[float]) -> Callable:
    def timed(*args: object, **kwargs: object) -> object:
        began = time.perf_counter()
        try:
            return work(*args, **kwargs)
        finally:
            spent.append(time.perf_counter() - began)

    return timed


if __name__ == '__main__':
    in_database: list[float] = []
    grading.store = _timed(grading.store, in_database)
    status = main(sys.argv[2:], course=Course(gradebook=Path(sys.argv[1])))
    print(f'seconds in the database: {sum(in_database):.3f}', file=sys.stderr)
    sys.exit(status)
