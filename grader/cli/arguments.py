"""The arguments of `./course`: verbs, their options, and the texts of `--help`.

Parsing them imports nothing that grades: `tests/test_command_line.py` lists what must not be.
"""

import argparse
from pathlib import Path

from my_robot_basics.language.catalogues import ENGLISH, LOCALE, languages

from grader.cli import verbs
from grader.cli.argument_types import VerbParser, at_least_one, date, hexadecimal
from grader.common.argument_values import PLATFORMS, RECORDED


def make_parser() -> argparse.ArgumentParser:
    """Return the parser; the parsed arguments have the verb's function as `run`."""
    parser = argparse.ArgumentParser(prog='./course', description='Release, grade, tell.')
    subparsers = parser.add_subparsers(required=True, metavar='VERB', parser_class=VerbParser)

    def add(name: str, *, help: str) -> argparse.ArgumentParser:
        description = f'{help[0].upper()}{help[1:]}.'
        return subparsers.add_parser(name, help=help, description=description)

    verb = add('release', help="make the students' notebooks/ from solutions/")
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='only this one')
    verb.add_argument(
        '--fresh-outputs',
        action='store_true',
        help='take all outputs that solutions/ holds; by default, outputs that nbval would call '
        'the same as those of the last release stay',
    )
    verb.set_defaults(run=verbs.run_release)

    verb = add('bundle', help='make the zip that students get')
    verb.add_argument(
        'file',
        nargs='?',
        type=Path,
        default=Path('students.zip'),
        metavar='FILE',
        help='students.zip, unless you name another',
    )
    verb.set_defaults(run=verbs.run_bundle)

    verb = add('translate', help='bring the catalogues of other languages up to date')
    verb.set_defaults(run=verbs.run_translate)

    verb = add('collect', help='collect a folder or an archive of submissions')
    text = 'what came in: notebooks named STUDENT_ASSIGNMENT.ipynb, or as a platform names them'
    verb.add_argument('source', type=Path, metavar='FOLDER|ZIP|TAR', help=text)
    verb.add_argument(
        '--file-times',
        action='store_true',
        help="use a file's modification time as the time of submission if nothing else gives it",
    )
    verb.set_defaults(run=verbs.run_collect)

    verb = add('due', help='list due dates, or set one')
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='whose date to set')
    verb.add_argument(
        'when',
        nargs='?',
        type=date,
        metavar='DATE|none',
        help="2026-11-30 (its end), '2026-11-30 18:00', with a zone or in this machine's",
    )
    verb.add_argument('--student', metavar='ID', help='extend it for this student alone')
    verb.set_defaults(run=verbs.run_due)

    verb = add('grade', help='grade what is in gradebook/submitted/')
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='only this one')
    verb.add_argument('--student', metavar='ID', help='only this student')
    verb.add_argument(
        '--seed',
        type=hexadecimal,
        metavar=f'HEX|{RECORDED}',
        help='grade once more with these inputs of hidden tests, and only compare',
    )
    verb.add_argument('--store', action='store_true', help='store the scores of --seed HEX')
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
    text, known = 'of the page that reports the run', [ENGLISH, *languages(LOCALE)]
    verb.add_argument('--language', choices=known, default=ENGLISH, help=text)
    verb.set_defaults(run=verbs.run_grade, begin=verbs.begin_grade)

    verb = add('serve', help='grade what is handed in, as soon as it is')
    verb.add_argument(
        'folder',
        nargs='?',
        type=Path,
        metavar='FOLDER',
        help="where submissions are put: the inbound folder of nbgrader's exchange, or another",
    )
    verb.add_argument(
        '--status', action='store_true', help='say what is waiting, and what is done'
    )
    verb.add_argument('--once', action='store_true', help='end when nothing is left to grade')
    verb.add_argument('--workers', type=at_least_one, metavar='N', help='as for grade')
    verb.add_argument('--trust-students', action='store_true', help='as for grade')
    verb.set_defaults(run=verbs.run_serve)

    verb = add('scores', help='write gradebook/scores.csv')
    verb.add_argument(
        'assignment',
        nargs='?',
        default='',
        metavar='ASSIGNMENT',
        help='with --format or --send: only this',
    )
    form = verb.add_mutually_exclusive_group()
    form.add_argument(
        '--totals',
        action='store_true',
        help='write gradebook/totals.csv: a row for each student, a column for each assignment',
    )
    form.add_argument(
        '--format',
        choices=PLATFORMS,
        help='write what this platform imports, a file for each assignment: gradebook/PLATFORM/',
    )
    form.add_argument(
        '--send',
        choices=['lti'],
        help='give the platform of gradebook/lti.toml the scores that have changed (docs/lti.md)',
    )
    verb.add_argument(
        '--roster',
        type=Path,
        metavar='FILE',
        help="with --format: the platform's own table, to take students and columns from",
    )
    verb.set_defaults(run=verbs.run_scores)

    verb = add('feedback', help='write a page of feedback for each submission')
    verb.add_argument(
        '--zip',
        choices=['moodle'],
        help='pack them, too, as the feedback files that this platform takes',
    )
    verb.set_defaults(run=verbs.run_feedback)

    verb = add('solutions', help='write the answers, for after the deadline')
    verb.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='only this one')
    verb.add_argument(
        '--early', action='store_true', help='even if somebody may still submit (./course due)'
    )
    verb.set_defaults(run=verbs.run_solutions)

    for name, run, text in (
        ('demo', verbs.run_demo, 'grade a sample class, to see all of it in about a minute'),
        (
            'doctor',
            verbs.run_doctor,
            'show what isolates student code on this machine, and what is missing',
        ),
    ):
        add(name, help=text).set_defaults(run=run)
    return parser
