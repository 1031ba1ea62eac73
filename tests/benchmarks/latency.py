"""How long the grading of one submission takes, alone and beside others: p50, p95 and p99.

    .venv/bin/python tests/benchmarks/latency.py [LESSON ...] [--beside 0 1 10 50] [--rounds 1]

For each lesson, all its sample answers, right and wrong, are submitted to warm workers. As soon as
one is graded the next is submitted, so the number of others is constant. The time is measured from
submitting to the verdict: it includes waiting for a turn, but not storing and feedback.
"""

import argparse
import itertools
import statistics
import time
from concurrent.futures import FIRST_COMPLETED, Future, wait

from measuring import new_course
from sample_class import PATHS, assignment_of, hand_in

from grader.grading import Grading, PreparedAssignment
from grader.storage.submitted import SubmissionFolder, find_submissions
from grader.workers.workers import Workers

LESSONS = tuple(sorted({assignment_of(path) for path in PATHS.values()}))


def main() -> None:
    """Print a row for each lesson and number of others."""
    parser = argparse.ArgumentParser()
    parser.add_argument('lessons', nargs='*', default=LESSONS, metavar='LESSON')
    parser.add_argument('--beside', nargs='+', type=int, default=[0, 1, 10, 50])
    parser.add_argument('--rounds', type=int, default=1, help='of all samples of a lesson')
    asked = parser.parse_args()
    course = new_course('latency')
    hand_in(course, [name for name, path in PATHS.items() if assignment_of(path) in asked.lessons])
    found = list(find_submissions(course))
    print(f'{"lesson":18} beside  gradings   p50 s   p95 s   p99 s  a minute', flush=True)
    with Workers() as workers:
        isolated = workers.require_isolation()
        grading = Grading(course, workers, isolated=isolated, force=True)
        for lesson in asked.lessons:
            theirs = [each for each in found if each.assignment == lesson]
            prepared = grading.prepare(lesson)
            latencies(grading, prepared, theirs[:2], beside=1, count=2)  # warms the workers up
            for beside in asked.beside:
                count = max(asked.rounds * len(theirs), 2 * (beside + 1))
                took = latencies(grading, prepared, theirs, beside=beside, count=count)
                p50, p95, p99, a_minute = percentiles(took)
                figures = f'{len(took):9} {p50:7.1f} {p95:7.1f} {p99:7.1f} {a_minute:9.1f}'
                print(f'{lesson:18} {beside:6} {figures}', flush=True)  # all takes most of an hour


def latencies(
    grading: Grading,
    prepared: PreparedAssignment,
    submissions: list[SubmissionFolder],
    *,
    beside: int,
    count: int,
) -> dict[Future, tuple[float, float]]:
    """Have `count` submissions graded, `beside` + 1 at a time; return start and end of each."""
    began: dict[Future, float] = {}
    ended: dict[Future, float] = {}
    under_way: set[Future] = set()
    for found in itertools.islice(itertools.cycle(submissions), count):
        start = time.monotonic()
        work = grading.start(found, prepared)
        began[work] = start
        work.add_done_callback(lambda work: ended.setdefault(work, time.monotonic()))
        under_way.add(work)
        if len(under_way) > beside:
            _, under_way = wait(under_way, return_when=FIRST_COMPLETED)
    for work in began:
        work.result()  # raises if a submission could not be graded
    while len(ended) < len(began):  # a future is done before it runs its callbacks
        time.sleep(0.001)
    return {work: (start, ended[work]) for work, start in began.items()}


def percentiles(took: dict[Future, tuple[float, float]]) -> tuple[float, float, float, float]:
    """Return p50, p95 and p99 in seconds, and how many were graded in a minute."""
    hundredths = statistics.quantiles(
        [end - start for start, end in took.values()], n=100, method='inclusive'
    )
    starts, ends = zip(*took.values(), strict=True)
    return (*(hundredths[i] for i in (49, 94, 98)), 60 * len(took) / (max(ends) - min(starts)))


if __name__ == '__main__':
    main()
