"""The arguments of `./course grade` and `./course serve`."""

from pathlib import Path

from my_robot_basics.language.catalogues import ENGLISH, LOCALE, languages

from grader.cli import verbs
from grader.cli.argument_types import AddVerb, at_least_one, hexadecimal
from grader.common.argument_values import RECORDED


def add_grade(add: AddVerb) -> None:
    """Add `grade`, with all that it may be told."""
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
    verb.set_defaults(run=verbs.run_grade, begin=verbs.try_sandbox_early)


def add_serve(add: AddVerb) -> None:
    """Add `serve`."""
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
