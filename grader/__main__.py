"""The command line: `python -m grader VERB`, which is what `./course VERB` runs."""

import argparse
import contextlib
import sys
from datetime import datetime
from pathlib import Path

from grader.bundle import bundle
from grader.cluster import Cluster
from grader.collect import LEFT, collect
from grader.connection import Certificates
from grader.course import Course
from grader.crew import Crew
from grader.database import in_sentences
from grader.demo import demo
from grader.errors import CourseError
from grader.feedback import write_feedback
from grader.grade import HandedIn, find_submissions, grade_all
from grader.gradebook import register
from grader.intake import lines
from grader.isolation import missing, protections, slow
from grader.release import release
from grader.replay import RECORDED, replay
from grader.report import Run, write_report
from grader.scores import write_scores
from grader.stopping import stoppable
from grader.table import changes, print_rows
from grader.text import printable
from grader.workers import Workers


def main(arguments: list[str] | None = None, *, course: Course | None = None) -> int:
    """Run one command; return its exit status: 0, 1 when something needs a look, 130 on Ctrl-C.

    It is 143 on SIGTERM and 129 on SIGHUP, which end a run in the same way.
    """
    asked = _parser().parse_args(arguments)
    with stoppable() as stop:
        try:
            course = course or Course()
            with in_sentences(course):
                return asked.run(course, asked)
        except CourseError as error:
            print(f'course: {printable(error)}', file=sys.stderr)
            return 1
        except KeyboardInterrupt as told:
            kept = f'{told}' or 'What was finished is kept'
            with contextlib.suppress(OSError):  # SIGHUP: the terminal is gone
                print(f'\ncourse: stopped. {kept}; run it again to go on.', file=sys.stderr)
            return stop.status


def _release(course: Course, asked: argparse.Namespace) -> int:
    wanted = [asked.assignment] if asked.assignment else course.assignments()
    if (course.gradebook / 'gradebook.db').exists():
        for assignment in wanted:
            register(course, assignment)  # refuses what graded submissions can't follow
    changed = release(course, asked.assignment or '*')
    for path in changed:
        print(f'notebooks/{path}')
    print(f'{len(changed)} files changed.' if changed else 'Nothing has changed.')
    return 0


def _bundle(course: Course, asked: argparse.Namespace) -> int:
    made = bundle(course, asked.file)
    for path in made.left_out:
        print(f'left out: {path}')
    print(f'{asked.file}: {len(made.files)} files, {made.bytes / 1e6:.1f} MB')
    return 0


def _collect(course: Course, asked: argparse.Namespace) -> int:
    rows = list(collect(course, asked.source, file_times=asked.file_times))
    for line in lines(rows):
        print(line)
    taken = any(row.student_id for row in rows)
    if taken:
        print('Next: ./course grade')
    return 0 if taken and not any(row.outcome == LEFT for row in rows) else 1


def _grade(course: Course, asked: argparse.Namespace) -> int:
    crew = _crew(asked)
    submissions = find_submissions(course, assignment=asked.assignment, student_id=asked.student)
    if asked.store and asked.seed == RECORDED:
        raise CourseError('--store wants --seed HEX: what is recorded is stored already')
    if asked.seed and not asked.store:
        return _replay(course, submissions, asked, crew)
    run = Run(datetime.now().astimezone(), seed=asked.seed or '')
    graded = grade_all(
        course,
        submissions,
        crew=crew,
        seed=asked.seed or '',
        trust_students=asked.trust_students,
        force=asked.force,
    )
    rows = []
    try:
        for row in print_rows(graded, submissions):
            rows.append(row)
    except KeyboardInterrupt:
        graded.close()  # ends all that runs, before anybody is told so
        told = f'{len(rows)} of {len(submissions)} submissions are graded and stored'
        raise KeyboardInterrupt(told) from None
    report = write_report(course, run, rows)
    if changed := changes(rows):
        print(f'{len(changed)} score{"s" * (len(changed) > 1)} changed:')
        print(*(f'  {line}' for line in changed), sep='\n')
    failed = sum(row.stored is None for row in rows)
    waiting = sum(row.stored is not None and row.stored.pending for row in rows)
    print(
        f'{len(rows) - failed} graded, {waiting} of them wait for a person (…), '
        f'{failed} could not be graded (–).\n'
        f'Report: {report}\nNext: ./course feedback, ./course scores'
    )
    return 1 if failed else 0


def _crew(asked: argparse.Namespace) -> Crew | None:
    certificates = Certificates(asked.tls_ca_file, asked.tls_cert, asked.tls_key)
    if not asked.dask:
        if certificates != Certificates():
            raise CourseError('--tls-ca-file, --tls-cert and --tls-key go with --dask tls://…')
        return Workers(asked.workers) if asked.workers else None
    if asked.trust_students:
        raise CourseError(
            '--trust-students and --dask do not go together: a worker without a sandbox would '
            'run what students wrote with the rights of all the cluster'
        )
    return Cluster(asked.dask, certificates)


def _replay(
    course: Course, submissions: list[HandedIn], asked: argparse.Namespace, crew: Crew | None
) -> int:
    same = True
    for line, as_stored in replay(
        course,
        submissions,
        crew=crew,
        seed=asked.seed,
        trust_students=asked.trust_students,
    ):
        print(line, flush=True)
        same &= as_stored
    print('The same as in the gradebook.' if same else 'NOT the same as in the gradebook.')
    print('Nothing was stored; --store stores it.')
    return 0 if same else 1


def _scores(course: Course, asked: argparse.Namespace) -> int:
    print(write_scores(course))
    return 0


def _feedback(course: Course, asked: argparse.Namespace) -> int:
    pages = write_feedback(course, say=lambda line: print(printable(line)))
    print(f'{len(pages)} pages in {course.folder("feedback", "", "")}')
    return 0


def _demo(course: Course, asked: argparse.Namespace) -> int:
    return 0 if demo(root=course.root) else 1


def _doctor(course: Course, asked: argparse.Namespace) -> int:
    print('What keeps student code in while it is graded:')
    for protection in protections():
        print(f'  {"MISSING" if protection.problem else "ok     "}  {protection.name}')
    if problem := missing():
        print(f'\n{problem[0].upper()}{problem[1:]}.')
        return 1
    print('Nothing is missing: ./course grade runs each submission in a sandbox.')
    if problem := slow():
        print(f'It is slower than it could be: no kernel can be forked here, for {problem}.')
    return 0


def hexadecimal(text: str) -> str:
    """Check an argument; argparse names this function when it is wrong."""
    if text != RECORDED:
        int(text, 16)
    return text


def at_least_one(text: str) -> int:
    """Check an argument; argparse shows what this raises."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'{text!r} is not a number from 1 on')
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='./course', description='Release, grade, tell.')
    verbs = parser.add_subparsers(required=True, metavar='VERB')

    verb = verbs.add_parser('release', help="make the students' notebooks/ from solutions/")
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='only this one')
    verb.set_defaults(run=_release)

    verb = verbs.add_parser('bundle', help='make the zip that students get')
    verb.add_argument('file', nargs='?', type=Path, default=Path('students.zip'), metavar='FILE')
    verb.set_defaults(run=_bundle)

    verb = verbs.add_parser('collect', help='take in a folder or an archive of submissions')
    verb.add_argument('source', type=Path, metavar='FOLDER|ZIP|TAR')
    verb.add_argument(
        '--file-times',
        action='store_true',
        help="take a file's own time for the time it was handed in, where nothing else tells",
    )
    verb.set_defaults(run=_collect)

    verb = verbs.add_parser('grade', help='grade what lies in gradebook/submitted/')
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='only this one')
    verb.add_argument('--student', metavar='ID', help='only this student')
    verb.add_argument(
        '--seed',
        type=hexadecimal,
        metavar=f'HEX|{RECORDED}',
        help='grade once more with these inputs of hidden tests, and only compare',
    )
    verb.add_argument('--store', action='store_true', help='store what --seed HEX comes to')
    verb.add_argument(
        '--trust-students',
        action='store_true',
        help='grade even where this machine has no sandbox for their code (./course doctor)',
    )
    where = verb.add_mutually_exclusive_group()
    where.add_argument(
        '--workers',
        type=at_least_one,
        metavar='N',
        help='grade in so many processes; without it, one for each core',
    )
    where.add_argument(
        '--dask',
        metavar='tls://HOST:8786',
        help='grade on the workers of this Dask scheduler; on this machine, tcp://127.0.0.1:8786',
    )
    for option in ('--tls-ca-file', '--tls-cert', '--tls-key'):
        verb.add_argument(option, metavar='FILE', help='for --dask tls://…, as dask takes it')
    verb.add_argument(
        '--force', action='store_true', help='grade again what has not changed since, too'
    )
    verb.set_defaults(run=_grade)

    for name, run, text in (
        ('scores', _scores, 'write gradebook/scores.csv'),
        ('feedback', _feedback, 'write a page of feedback for each submission'),
        ('demo', _demo, 'grade a sample class, to see all of it in about a minute'),
        ('doctor', _doctor, 'say what keeps student code in on this machine, and what is missing'),
    ):
        verbs.add_parser(name, help=text).set_defaults(run=run)
    return parser


if __name__ == '__main__':
    sys.exit(main())
