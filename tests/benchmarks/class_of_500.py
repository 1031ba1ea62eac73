"""A class of five hundred, from the archive that comes in to feedback; every score is verified.

    .venv/bin/python tests/benchmarks/class_of_500.py [--students 500] [--workers N]
    .venv/bin/python tests/benchmarks/class_of_500.py --kill run worker
    .venv/bin/python tests/benchmarks/class_of_500.py --steady 200

`--kill run` grades the class once more, ends the run in mid-class with SIGKILL, twice, goes on
each time, and compares all that is in the gradebook with that of the run which nobody ended.
`--kill worker` does so to a worker process, twice, while the run goes on. `--steady` grades the
right answers of lessons 2 and 3 so many times instead, beside two busy loops, and counts the
scores that differ. Ends with 1 where a score is wrong.
"""

import argparse
import json
import shutil
import sys
from collections.abc import Sequence
from dataclasses import replace

import psutil
from measuring import (
    Course,
    Watched,
    busy,
    course_command,
    kill_a_worker,
    new_course,
    table,
    watch,
)
from sample_class import PATHS, assignment_of
from synthetic_class import Paper, synthetic_class, wrong_scores, zip_up

from grader.collect import collect
from grader.records import records

ROW = r'^student_\d+ '
STEADY = ('02_joint_state', '03_publisher')
MOST_SHOWN = 20


def main() -> int:
    """Grade what was asked for, and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--students', type=int, default=500)
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--workers', help='for ./course grade; default: its own')
    parser.add_argument('--kill', nargs='+', choices=('run', 'worker'), default=())
    parser.add_argument('--steady', type=int, metavar='TIMES')
    asked = parser.parse_args()
    options = ['--workers', asked.workers] if asked.workers else []
    if asked.steady:
        with busy(2):
            return _whole_class(_right_answers(asked.steady), options)[1]
    papers = synthetic_class(asked.students, seed=asked.seed)
    course, status = _whole_class(papers, options)
    differs = [_killed(what, course, papers, options) for what in asked.kill]
    return status or int(any(differs))


def _right_answers(times: int) -> list[Paper]:
    names = [name for name in PATHS if '-pass-' in name and assignment_of(PATHS[name]) in STEADY]
    return [
        replace(paper, student_id=f'student_{number:02}{paper.student_id[-4:]}')
        for number, name in enumerate(names)
        for paper in synthetic_class(times, samples=[name])
    ]


def _whole_class(papers: Sequence[Paper], options: list[str]) -> tuple[Course, int]:
    """Take a class from its archive to its feedback; return where it lies, and 1 if wrong."""
    course = new_course('class')
    archive = course.gradebook.with_name('class.zip')
    zip_up(papers, archive)
    steps = {'collect': ['collect', archive], 'grade': ['grade', *options]}
    steps |= {'again, unchanged': ['grade', *options]}
    steps |= {'scores': ['scores'], 'feedback': ['feedback']}
    ran: dict[str, Watched] = {}
    for name, arguments in steps.items():
        ran[name] = watch(course_command(course, *arguments), done=ROW)
        if name == 'grade':
            report = _report(course)
    print(f'{len(papers)} submissions in {course.gradebook}')
    table(
        ('', 'seconds', 'a minute', 'peak MB', 'database s', 'exit'),
        [
            (
                name,
                watched.seconds,
                60 * len(papers) / watched.seconds,
                watched.peak_bytes / 1e6,
                watched.database_sec,
                watched.status,
            )
            for name, watched in ran.items()
        ],
    )
    print('The report counts', ', '.join(f'{n} {what}' for what, n in report['counts'].items()))
    wrong = wrong_scores(course, papers)
    print(f'Wrong scores: {len(wrong)} of {sum(len(paper.expected) for paper in papers)}')
    for line in wrong[:MOST_SHOWN]:
        print(f'  {line}')
    pages = list(course.gradebook.glob('feedback/*/*/*.html'))
    print(f'Pages of feedback: {len(pages)} of {len(papers)}')
    complete = len(pages) == len(papers) == report['counts']['submissions']
    return course, 0 if complete and not wrong else 1


def _report(course: Course) -> dict:
    [path] = course.gradebook.glob('runs/*/report.json')
    return json.loads(path.read_text(encoding='utf-8'))


def _killed(what: str, whole: Course, papers: Sequence[Paper], options: list[str]) -> bool:
    """Grade the class once more, with kills; return whether it ends otherwise."""
    course = new_course('killed')
    list(collect(course, whole.gradebook.with_name('class.zip')))
    # hidden tests choose the same inputs
    shutil.copy(whole.gradebook / 'course_secret', course.gradebook)
    moments = [max(1, len(papers) // 3), max(2, 2 * len(papers) // 3)]
    if what == 'run':
        runs = [*({moment: psutil.Process.kill} for moment in moments), {}]
    else:
        runs = [dict.fromkeys(moments, kill_a_worker)]
    rows = []
    for meanwhile in runs:
        command = course_command(course, 'grade', *options)
        watched = watch(command, done=ROW, meanwhile=meanwhile)
        stored = len(list(course.gradebook.glob('autograded/*/*/*.ipynb')))
        unchanged = watched.said.count('(unchanged)')
        rows.append((watched.status, len(watched.done_at), unchanged, watched.seconds, stored))
    print(f'\nWith the {what} killed in mid-class, twice:')
    table(('exit', 'rows', 'unchanged', 'seconds', 'stored by then'), rows)
    found = [records(each) for each in (whole, course)]
    differ = [(one, other) for one, other in zip(*found, strict=True) if one != other]
    print(f'Differs from the run that nobody ended: {len(differ)} of {len(found[0])} scores')
    for one, other in differ[:MOST_SHOWN]:
        print(f'  {one}\n  {other}')
    return bool(differ)


if __name__ == '__main__':
    sys.exit(main())
