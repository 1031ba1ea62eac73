"""`./course validate`: run the visible checks of a lesson and print their results.

The exit code is 0 if all of them pass, 1 if not, and 2 if nothing could be checked.
"""

import asyncio
import json
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.session.arguments import Arguments
from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.kernels.forks import ForkServer
from my_robot_basics.validate.reports.report_words import front_end_texts

if TYPE_CHECKING:
    from my_robot_basics.validate.reports.report import Report


def main(arguments: list[str] | None = None) -> int:
    """Validate the notebook that the command line names; return the exit code."""
    parser = Arguments(
        prog='./course validate',
        description=in_language_here(
            'Run the visible checks of a lesson. Exit code: 0 if all of them pass, 1 if not, 2 if '
            'nothing could be checked.'
        ),
    )
    about = in_language_here('a saved notebook of the course')
    parser.add_argument('notebook', type=Path, metavar='NOTEBOOK', help=about)
    about = in_language_here('write a line of JSON for each step and the report')
    parser.add_argument('--json', action='store_true', help=about)
    options = parser.parse_args(arguments)
    say = _say_json if options.json else _say
    told: list[Report] = []
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # so that its kernels end, too
    try:
        with ForkServer() as server:
            # imported here, while the fork server does its own imports
            from my_robot_basics.validate.progress.remembering import remember
            from my_robot_basics.validate.reports.as_text import as_text
            from my_robot_basics.validate.running.run import validate

            def tell(report: 'Report') -> None:
                told.append(remember(report, options.notebook))
                if options.json:
                    _write({'report': told[0].as_data()})
                else:
                    _clear()
                    print(as_text(told[0]), flush=True)

            speak = _write_words if options.json else lambda language: None
            asyncio.run(validate(options.notebook, server, say=say, speak=speak, tell=tell))
    except KeyboardInterrupt:
        return 130
    except CourseError as error:
        if options.json:
            _write({'failed': in_language_here(str(error))})
        else:
            print(f'validate: {in_language_here(str(error))}', file=sys.stderr)
        return 2
    return 0 if told[0].passed else 1


def _say(line: str) -> None:
    """Show the progress on a terminal, in one line that the next one replaces."""
    if sys.stderr.isatty():
        print(f'\r\033[K{line:.78}', end='', file=sys.stderr, flush=True)


def _clear() -> None:
    if sys.stderr.isatty():
        print('\r\033[K', end='', file=sys.stderr, flush=True)


def _say_json(line: str) -> None:
    _write({'progress': line})


def _write_words(language: str) -> None:
    """Send JupyterLab's dialog the translations of its words; it has the English ones."""
    if language != ENGLISH:
        _write({'words': front_end_texts(language)})


def _write(message: dict) -> None:
    print(json.dumps(message), flush=True)


if __name__ == '__main__':
    sys.exit(main())
