"""How long a student waits with `serve`: from a complete file to the feedback on disk.

    .venv/bin/python tests/benchmarks/serve_latency.py [--students 20] [--rounds 1]

Sample answers to lesson 3, right and wrong, are handed in as `nbgrader submit` does it: first one
after another, then by 20 students within a minute. It prints p50, p95 and the slowest ones.
"""

import argparse
import random
import shutil
import statistics
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from measuring import ROOT, course_command, new_course, table
from nbgrader.utils import notebook_hash

LESSON = '03_publisher'
SAMPLES = sorted((ROOT / 'tests/submissions').glob(f'{LESSON}-*.ipynb'))
MOST_SEC = 600.0
"""A submission without feedback after so long counts as lost."""


def main() -> None:
    """Serve an empty gradebook, hand in, and print how long it took."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--students', type=int, default=20)
    parser.add_argument('--answers', type=int, default=len(SAMPLES), help='only the first ones')
    parser.add_argument(
        '--rounds', type=int, default=1, help='of all samples, one after the other'
    )
    asked = parser.parse_args()
    course = new_course('serve')
    course.gradebook.mkdir()
    exchange = course.gradebook.with_name('exchange')
    for name in ('inbound', 'outbound', 'feedback'):
        (exchange / name).mkdir(parents=True)
    with serving(course_command(course, 'serve', exchange / 'inbound')):
        took([put(exchange, SAMPLES[0], 'first')])  # starts the worker
        alone = [
            (sample.stem, *took([put(exchange, sample, f'alone{number}_{n}')]))
            for number in range(asked.rounds)
            for n, sample in enumerate(SAMPLES[: asked.answers])
        ]
        show('one after the other', alone)
        show(
            f'{asked.students} students in one minute', list(in_a_minute(exchange, asked.students))
        )


def in_a_minute(exchange: Path, students: int) -> Iterator[tuple[str, float]]:
    """Hand in for some students at random times in a minute; yield the seconds of each one."""
    chance = random.Random(5)
    chosen = [chance.choice(SAMPLES) for _ in range(students)]
    began, pages = time.time(), []
    for number, (at, sample) in enumerate(
        zip(sorted(chance.uniform(0, 60) for _ in chosen), chosen, strict=True)
    ):
        time.sleep(max(0.0, began + at - time.time()))
        pages.append(put(exchange, sample, f'minute{number}'))
    yield from zip((sample.stem for sample in chosen), took(pages), strict=True)


def put(exchange: Path, sample: Path, student: str) -> tuple[Path, float]:
    """Hand a sample in; return the path of its page, and the time when it was complete."""
    folder = exchange / 'inbound' / f'{student}+{LESSON}+2026-01-01 10:00:00.0 UTC+x'
    folder.mkdir()
    shutil.copy(sample, folder / f'{LESSON}.ipynb')
    (folder / 'timestamp.txt').write_text('2026-01-01 10:00:00.0 UTC')
    (folder / 'submission_secret.txt').write_text(student)
    folder.chmod(0o777)
    name = notebook_hash(secret=student, notebook_id=LESSON)
    return exchange / 'feedback' / f'{name}.html', time.time()


def took(pages: Sequence[tuple[Path, float]]) -> list[float]:
    """Wait for pages; return the seconds that each one took."""
    deadline = time.time() + MOST_SEC
    while not all(page.exists() for page, _ in pages):
        if time.time() > deadline:
            raise SystemExit(f'no feedback within {MOST_SEC:.0f} s')
        time.sleep(0.05)
    return [page.stat().st_mtime - at for page, at in pages]


def show(what: str, found: Sequence[tuple[str, float]]) -> None:
    """Print the median, the 95th percentile, and a table with the slowest first."""
    seconds = [each for _, each in found]
    twentieths = statistics.quantiles(seconds, n=20, method='inclusive')
    print(f'\n{what}: {len(found)}, p50 {twentieths[9]:.1f} s, p95 {twentieths[18]:.1f} s')
    table(('answer', 'seconds'), sorted(found, key=lambda each: -each[1]))


@contextmanager
def serving(command: Sequence[str]) -> Iterator[None]:
    """Run the command, and end it as systemd does."""
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait()


if __name__ == '__main__':
    main()
