"""Grade an honest class again and again on a busy machine: does every score stay the same?

A round is one right answer of each lesson. A lesson's right answers take turns, so that every
`-pass-` sample is graded, most of them several times. Each line counts all rounds so far, so the
result of an interrupted run is known.

For named lessons, a round is all of their samples, including wrong ones: these have to fail for
the expected reasons.
"""

import os
import statistics
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

import psutil
from loads import beside, telling_pressure
from measuring import ROW, Course, course_command, minutes, new_course, watch
from sample_class import EXPECTED, PATHS, assignment_of
from synthetic_class import Paper, synthetic_class, wrong_scores, zip_up

from grader.collect.collect import collect
from grader.storage.records import verdicts

RIGHT = tuple(name for name in PATHS if '-pass-' in name)
LESSONS = len({assignment_of(PATHS[name]) for name in RIGHT})


def honest_rounds(rounds: int) -> list[Paper]:
    """Return the submissions of these rounds, one round after another, each by another student."""
    return synthetic_class(LESSONS * rounds, samples=RIGHT)


def lesson_rounds(rounds: int, lessons: Sequence[str]) -> list[Paper]:
    """Return the submissions of these rounds of all samples of the lessons, in the same way."""
    samples = [name for name in PATHS if assignment_of(PATHS[name]) in lessons]
    by_sample = [synthetic_class(rounds, samples=[name]) for name in samples]
    in_turn = [paper for one_of_each in zip(*by_sample, strict=True) for paper in one_of_each]
    return [
        replace(paper, student_id=f'student_{number:04}')
        for number, paper in enumerate(in_turn, start=1)
    ]


def steady(
    rounds: int,
    options: Sequence[str],
    folder: Path | None,
    *,
    lessons: Sequence[str] = (),
    loads: Sequence[str] = ('busy',),
) -> int:
    """Grade the rounds under these loads; return 1 if a score differs or is missing.

    If `folder` is the gradebook of an interrupted run, only what is missing in it is graded.
    """
    papers = lesson_rounds(rounds, lessons) if lessons else honest_rounds(rounds)
    size = len(papers) // rounds
    course = Course(gradebook=folder.resolve()) if folder else new_course('steady')
    print(
        f'{len(papers)} gradings in {rounds} rounds; go on with --at {course.gradebook}',
        flush=True,
    )
    course.gradebook.mkdir(parents=True, exist_ok=True)
    archive = course.gradebook.with_name('class.zip')
    zip_up(papers, archive)
    list(collect(course, archive))
    progress = _Progress(course, papers, size)
    ends = range(size, len(papers) + 1, size)
    with ExitStack() as occupied:
        occupied.enter_context(telling_pressure())

        def occupy(_: psutil.Process) -> None:
            occupied.enter_context(beside(loads, course.gradebook))

        watched = watch(
            course_command(course, 'grade', *options),
            done=ROW,
            # not before the first result, because the run first measures the available memory
            meanwhile={1: occupy} | {end: partial(progress.tell, end) for end in ends},
        )
    return progress.conclude(len(watched.done_at), watched.said.count('(unchanged)'))


class _Progress:
    """Counts what differs after each round, and at the end once more in all stored results."""

    def __init__(self, course: Course, papers: Sequence[Paper], size: int) -> None:
        self._course, self._papers, self._size = course, papers, size
        self._wrong: list[str] = []
        self._loads: list[float] = []
        self._began = time.perf_counter()

    def tell(self, end: int, _: psutil.Process) -> None:
        """Check the round that ended with this grading, and print the counts so far."""
        found = _differences(self._course, self._papers[end - self._size : end])
        self._wrong += found
        self._loads.append(os.getloadavg()[0])
        print(
            f'round {end // self._size}: {self._standing(end)}, load {self._loads[-1]:.1f}',
            flush=True,
        )
        _show(found)

    def conclude(self, done: int, from_before: int) -> int:
        """Check all stored results, and print the counts; return 1 if something differs."""
        graded = self._papers[:done]
        self._wrong = _differences(self._course, graded)
        times = Counter(paper.sample for paper in graded)
        print(f'\n{self._standing(done)}')
        _show(self._wrong)
        if times:
            print(
                f'{len(times)} samples, each graded {min(times.values())} '
                f'to {max(times.values())} times; {from_before} in an earlier run'
            )
        if self._loads:
            mean, most = statistics.fmean(self._loads), max(self._loads)
            print(f'load average {mean:.1f}, at most {most:.1f}, on {os.cpu_count()} processors')
        if done < len(self._papers):
            print(f'CUT SHORT: {len(self._papers) - done} were not graded')
        return int(bool(self._wrong) or done < len(self._papers))

    def _standing(self, done: int) -> str:
        scores = sum(len(paper.expected) for paper in self._papers[:done])
        return (
            f'{done} gradings, {len(self._wrong)} of {scores} scores or reasons differ, '
            f'{minutes(time.perf_counter() - self._began)}'
        )


def _differences(course: Course, papers: Sequence[Paper]) -> list[str]:
    """Return a line for each wrong score, and for each reason without an expected word."""
    wrong = wrong_scores(course, papers)
    for paper in papers:
        found = verdicts(course, paper.student_id, paper.assignment)
        for name, (_, *words) in EXPECTED[paper.sample].items():
            said = found.get(name, {})
            told = ' | '.join([said.get('reason', ''), *said.get('notes', ())])
            if missing := [word for word in words if word not in told]:
                whose = f'{paper.student_id} {name} ({paper.sample})'
                wrong.append(f'{whose}: expected {missing}, the reason is: {told}')
    return wrong


def _show(wrong: Sequence[str]) -> None:
    for line in wrong:
        print(f'  {line}', flush=True)
