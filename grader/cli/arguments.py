"""The arguments of `./course`: verbs, their options, and the texts of `--help`.

Parsing them imports nothing that grades: `tests/test_command_line.py` lists what must not be.
"""

import argparse
from pathlib import Path

from grader.cli import grading_arguments, verbs
from grader.cli.argument_types import AddVerb, VerbParser, date
from grader.common.argument_values import PLATFORMS


def make_parser() -> argparse.ArgumentParser:
    """Return the parser; the parsed arguments have the verb's function as `run`."""
    parser = argparse.ArgumentParser(prog='./course', description='Release, grade, tell.')
    subparsers = parser.add_subparsers(required=True, metavar='VERB', parser_class=VerbParser)

    def add(name: str, *, help: str) -> argparse.ArgumentParser:
        description = f'{help[0].upper()}{help[1:]}.'
        return subparsers.add_parser(name, help=help, description=description)

    # in the order in which --help lists them
    _add_authoring(add)
    _add_collecting(add)
    grading_arguments.add_grade(add)
    grading_arguments.add_serve(add)
    _add_scores(add)
    _add_handing_back(add)
    _add_trying(add)
    return parser


def _add_authoring(add: AddVerb) -> None:
    """Add the verbs that make what students get."""
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


def _add_collecting(add: AddVerb) -> None:
    """Add the verbs for what students hand in, and until when."""
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


def _add_scores(add: AddVerb) -> None:
    """Add `scores`, in all its forms."""
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


def _add_handing_back(add: AddVerb) -> None:
    """Add the other verbs for what students get back."""
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


def _add_trying(add: AddVerb) -> None:
    """Add the verbs that try the grader and this machine."""
    verb = add('demo', help='grade a sample class, to see all of it in about a minute')
    verb.set_defaults(run=verbs.run_demo)

    text = 'show what isolates student code on this machine, and what is missing'
    add('doctor', help=text).set_defaults(run=verbs.run_doctor)
