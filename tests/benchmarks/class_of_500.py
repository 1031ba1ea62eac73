"""Grade a class of five hundred, from its archive to feedback, and verify every score.

    .venv/bin/python tests/benchmarks/class_of_500.py [--students 500] [--workers N]
    .venv/bin/python tests/benchmarks/class_of_500.py --lessons 00 01 02 03 04 05 06 07
    .venv/bin/python tests/benchmarks/class_of_500.py --kill run worker
    .venv/bin/python tests/benchmarks/class_of_500.py --steady 200 [--at GRADEBOOK]
    .venv/bin/python tests/benchmarks/class_of_500.py --steady 20 --lessons 08
    .venv/bin/python tests/benchmarks/class_of_500.py --steady 2 --lessons 0 1 --beside memory disk

`--kill run` grades the class once more, kills the run with SIGKILL in mid-class, twice, continues
each time, and compares the whole gradebook with that of the undisturbed run. `--kill worker` kills
a worker process instead, twice, while the run goes on. `--steady` grades an honest class, one
right answer of each lesson, that many times beside two busy loops, and counts the scores that
differ; `--at` continues one that was interrupted. With `--lessons`, it grades all samples of those
lessons instead, right and wrong, and checks the reasons, too. `--beside` chooses other loads:
nearly no free memory, or a disk that others write to. The exit status is 1 if a score is wrong.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from killing import MOST_SHOWN, killed
from loads import KINDS
from measuring import ROW, Course, Watched, course_command, new_course, table, watch
from sample_class import PATHS, assignment_of
from steady import steady
from synthetic_class import Paper, synthetic_class, wrong_scores, zip_up


def main() -> int:
    """Grade as the options say, and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--students', type=int, default=500)
    parser.add_argument('--seed', type=int, default=0)
    about = 'these alone, by how their names begin; default: all, and with --steady right ones'
    parser.add_argument('--lessons', nargs='+', default=[], help=about)
    parser.add_argument('--workers', help='for ./course grade; default: its own')
    parser.add_argument('--kill', nargs='+', choices=('run', 'worker'), default=())
    parser.add_argument('--steady', type=int, metavar='TIMES')
    parser.add_argument('--at', type=Path, metavar='GRADEBOOK')
    about = 'for --steady; default: busy loops alone'
    parser.add_argument('--beside', nargs='+', choices=tuple(KINDS), default=['busy'], help=about)
    asked = parser.parse_args()
    options = ['--workers', asked.workers] if asked.workers else []
    all_lessons = sorted({assignment_of(path) for path in PATHS.values()})
    named = [name for name in all_lessons if name.startswith(tuple(asked.lessons))]
    if asked.lessons and not named:
        parser.error(f'no lesson begins with {" or ".join(asked.lessons)}')
    if asked.steady:
        return steady(asked.steady, options, asked.at, lessons=named, loads=asked.beside)
    papers = synthetic_class(asked.students, seed=asked.seed, assignments=named or all_lessons)
    course, status = _whole_class(papers, options)
    differs = [killed(what, course, papers, options) for what in asked.kill]
    return status or int(any(differs))


def _whole_class(papers: Sequence[Paper], options: list[str]) -> tuple[Course, int]:
    """Take a class from its archive to its feedback; return its course, and 1 if it is wrong."""
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


if __name__ == '__main__':
    sys.exit(main())
