"""The command line: `python -m grader VERB`, which is what `./course VERB` runs."""

import contextlib
import gc
import io
import os.path
import sys
from typing import TYPE_CHECKING, NoReturn

from grader.cli.arguments import make_parser
from grader.cli.stopping import PIPE_CLOSED, is_output_closed, stoppable
from grader.common.db_url import refuse_another_place
from grader.common.errors import CourseError

if TYPE_CHECKING:
    from grader.course import Course


def main(arguments: list[str] | None = None, *, course: 'Course | None' = None) -> int:
    """Run one command; return its exit status: 0, 1 if something needs attention, 130 on Ctrl-C.

    It is 143 on SIGTERM, 129 on SIGHUP, and 141 if nothing reads the output any more: these end a
    run in the same way.
    """
    asked = make_parser().parse_args(arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # stdout may be a pipe, for example to `tee`: each line has to appear when it is printed
        sys.stdout.reconfigure(line_buffering=True)
    with stoppable() as stop:
        try:
            # the arguments are valid: only now import what takes long
            if begin := getattr(asked, 'begin', None):
                begin(asked)
            from grader.common.lean_imports import leave_out_formats, leave_out_servers

            leave_out_servers()
            leave_out_formats()
            from grader.common.logs import log_visibly
            from grader.course import Course
            from grader.storage.failures import raise_gradebook_errors

            log_visibly()
            course = course or Course()
            refuse_another_place(course.root / 'nbgrader_config.py')
            _refuse_no_folder(course)
            with raise_gradebook_errors(course):
                return asked.run(course, asked)
        except CourseError as error:
            from grader.common.text import printable

            print(f'course: {printable(error)}', file=sys.stderr)
            return 1
        except (KeyboardInterrupt, RuntimeError) as error:
            # Python 3.11 wraps what is raised while it names a class's attributes, as in an import
            interrupt = error.__cause__ if isinstance(error, RuntimeError) else error
            if not isinstance(interrupt, KeyboardInterrupt):
                raise
            kept = f'{interrupt}' or 'What was finished is kept'
            with contextlib.suppress(OSError):  # SIGHUP: the terminal is gone
                print(f'\ncourse: stopped. {kept}; run it again to go on.', file=sys.stderr)
            return stop.status
        except BrokenPipeError:
            if not is_output_closed():
                raise
            print(
                'course: stopped, because nothing reads the output any more. What was finished is '
                'kept; run it again to go on.',
                file=sys.stderr,
            )
            return PIPE_CLOSED


def _refuse_no_folder(course: 'Course') -> None:
    """Raise CourseError if the gradebook's path exists and is not a folder."""
    gradebook = course.gradebook
    if os.path.lexists(gradebook) and not gradebook.is_dir():
        what = 'a file' if gradebook.exists() else 'a link that leads nowhere'
        raise CourseError(
            f'{gradebook} is {what}; a folder was expected: move it away, then run the same '
            'command again. Where there was a gradebook, put its folder back first.'
        )


def run() -> NoReturn:
    """Run the command that this process was started for, and end it."""
    status = main()
    gc.freeze()  # or Python searches all objects for garbage before it exits
    sys.exit(status)


if __name__ == '__main__':
    run()
