"""Submissions per minute, compared with stock nbgrader on the same files in the same run.

    .venv/bin/python tests/benchmarks/throughput.py [--papers 24] [--runs 3] [--workers 1 2]
    .venv/bin/python tests/benchmarks/throughput.py --sizes 10 100 1000
    .venv/bin/python tests/benchmarks/throughput.py --hostile

The files are the released lessons 2, 3, 4 and 7 with ordinary answers, right and wrong, and with
demonstrations. Stock is `nbgrader autograde`, one assignment after another, configured only with
this course's folders. Both have an empty gradebook each time. `cold` counts a command from its
start to its end, `warm` the time between its submissions. N workers of ours get N cores, so twice
as many have twice as much; stock has all cores. `--sizes` shows whether a submission costs the
same in a small class and in a large one. `--hostile` uses the other samples of these lessons,
those that hang, die, cheat or are damaged. Nothing is asserted: look at the ratios, because rates
depend on the machine.
"""

import argparse
import os
import shutil
import statistics
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import nbformat
from measuring import ROOT, Course, Watched, course_command, new_course, table, watch
from sample_class import PATHS, assignment_of
from synthetic_class import Paper, hand_in, synthetic_class, wrong_scores

from grader.notebook.restore import role

LESSONS = ('02_joint_state', '03_publisher', '04_subscriber', '07_common_errors')
HOSTILE = (
    *('-zero-', 'infinite_loop', 'blocking_spin', 'os_exit', 'patches_', 'searches_'),
    *('deleted_', 'repeated_', 'split_', 'edited_', 'skip_'),
)
"""Parts of the names of samples that are not ordinary answers."""
ROW = r'^student_\d+ '
STOCK_CONFIG = """
c = get_config()
c.CourseDirectory.source_directory = 'solutions'
c.CourseDirectory.release_directory = 'notebooks'
"""


def main() -> None:
    """Measure as the options say, and print the results."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--papers', type=int, default=24)
    parser.add_argument('--runs', type=int, default=3)
    parser.add_argument('--workers', type=int, nargs='*', default=[1, 2])
    parser.add_argument('--sizes', type=int, nargs='*')
    parser.add_argument('--hostile', action='store_true')
    asked = parser.parse_args()
    samples = [
        name
        for name in PATHS
        if assignment_of(PATHS[name]) in LESSONS
        and any(part in name for part in HOSTILE) == asked.hostile
    ]
    print(f'load at the start: {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} cores')
    if asked.sizes:
        _sizes(asked.sizes, samples)
    elif asked.hostile:
        _compare(_one_of_each(samples), workers=asked.workers[-1:], runs=1)
    else:
        papers = synthetic_class(asked.papers, samples=samples)
        _compare(papers, workers=asked.workers, runs=asked.runs)
    print(f'load at the end: {os.getloadavg()[0]:.1f}')


def _one_of_each(samples: Sequence[str]) -> list[Paper]:
    papers = []
    for number, name in enumerate(samples, start=1):
        [paper] = synthetic_class(1, samples=[name])
        papers.append(Paper(f'student_{number:04}', paper.assignment, name, paper.text))
    return papers


def _compare(papers: Sequence[Paper], *, workers: Sequence[int], runs: int) -> None:
    """Print the rates of stock nbgrader and of ours, measured alternately."""
    shorter = [_without_demonstrations(paper) for paper in papers]
    ways = {
        'stock': partial(_stock, papers),
        'stock, no demonstrations': partial(_stock, shorter),
        **{_name(number): partial(_ours, papers, number) for number in workers},
    }
    found: dict[str, list[dict]] = {name: [] for name in ways}
    for run in range(runs):
        # the first one in a round has colder caches
        for name in reversed(ways) if run % 2 else ways:
            found[name].append(one := ways[name]())
            print(f'  run {run + 1}, {name}: {one["cold"]:.1f} a minute', flush=True)
    of_stock = {kind: _median(found['stock'], kind) for kind in ('cold', 'warm')}
    print(f'{len(papers)} submissions, {len({p.sample for p in papers})} answers, {runs} runs')
    table(
        ('median', 'cold/min', 'ratio', 'warm/min', 'ratio', 'wrong scores', 'peak MB'),
        [
            (
                name,
                _median(each, 'cold'),
                f'{_median(each, "cold") / of_stock["cold"]:.2f}',
                _median(each, 'warm'),
                f'{_median(each, "warm") / of_stock["warm"]:.2f}',
                max(run['wrong'] for run in each),
                _median(each, 'peak'),
            )
            for name, each in found.items()
        ],
    )
    print(f'of {sum(len(paper.expected) for paper in papers)} scores')
    for few, many in pairwise(workers):
        scaled = _median(found[_name(many)], 'warm') / _median(found[_name(few)], 'warm')
        print(f'{few} to {many} workers, warm: {scaled:.2f} times; linear is {many / few:.2f}')
    for line in found['stock'][-1]['which']:
        print(f'  stock: {line}')
    for name, each in found.items():
        if name.startswith('ours') and any(run['wrong'] for run in each):
            print(*(f'  {name}: {line}' for run in each for line in run['which']), sep='\n')


def _median(runs: Sequence[dict], kind: str) -> float:
    return statistics.median(run[kind] for run in runs)


def _name(workers: int) -> str:
    return f'ours, --workers {workers}'


def _ours(papers: Sequence[Paper], workers: int) -> dict:
    course = new_course('ours')
    hand_in(course, papers)
    command = course_command(course, 'grade', '--workers', workers)
    with _cores(workers):
        return _found(course, papers, [watch(command, done=ROW)])


@contextmanager
def _cores(number: int) -> Iterator[None]:
    """Restrict this process, and all that it starts meanwhile, to this number of cores."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(before)[:number])
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def _stock(papers: Sequence[Paper]) -> dict:
    """Grade submissions with stock nbgrader, without this course's grader."""
    root = new_course('stock').gradebook
    lessons = sorted({paper.assignment for paper in papers})
    for lesson in lessons:
        shutil.copytree(ROOT / 'solutions' / lesson, root / 'solutions' / lesson)
    (root / 'nbgrader_config.py').write_text(STOCK_CONFIG, encoding='ascii')
    course = Course(gradebook=root)  # nbgrader's database is at the path of ours
    nbgrader = Path(sys.executable).with_name('nbgrader')
    for lesson in lessons:
        made = watch([nbgrader, 'generate_assignment', lesson], done='$^', cwd=root)
        assert made.status == 0, made.said
    hand_in(course, papers)
    ran = [
        watch([nbgrader, 'autograde', lesson], done=r'\bAutograding ', cwd=root)
        for lesson in lessons
    ]
    return _found(course, papers, ran)


def _found(course: Course, papers: Sequence[Paper], ran: Sequence[Watched]) -> dict:
    """Return rates per minute, wrong scores, and peak MB; remove the course."""
    between = [later - one for each in ran for one, later in pairwise(_warm(each))]
    wrong = wrong_scores(course, papers)
    shutil.rmtree(course.gradebook.parent)
    return {
        'cold': 60 * len(papers) / sum(each.seconds for each in ran),
        'warm': 60 / statistics.mean(between) if between else float('nan'),
        'wrong': len(wrong),
        'which': wrong,
        'peak': max(each.peak_bytes for each in ran) / 1e6,
    }


def _warm(watched: Watched) -> list[float]:
    """Return when submissions were done, without the first quarter."""
    done = watched.done_at
    return done[len(done) // 4 :]


def _without_demonstrations(paper: Paper) -> Paper:
    notebook = nbformat.reads(paper.text, as_version=4)
    notebook.cells = [cell for cell in notebook.cells if role(cell) != 'demo']
    return replace(paper, text=nbformat.writes(notebook))


def _sizes(sizes: Sequence[int], samples: Sequence[str]) -> None:
    """Print the cost of one submission in classes of these sizes."""
    rows = []
    for size in sizes:
        course, papers = new_course('size'), synthetic_class(size, samples=samples)
        hand_in(course, papers)
        watched = watch(course_command(course, 'grade'), done=ROW)
        rows.append(
            (
                f'{size} submissions',
                1000 * watched.seconds / size,
                60_000 / watched.per_minute_warm,
                1000 * watched.database_sec / size,
                watched.peak_bytes / 1e6,
                len(wrong_scores(course, papers)),
            )
        )
        shutil.rmtree(course.gradebook.parent)
    table(('', 'ms each', 'ms each, warm', 'ms database', 'peak MB', 'wrong scores'), rows)


if __name__ == '__main__':
    main()
