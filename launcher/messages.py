"""Messages of `./course` to the user: on stderr, in sentences."""

import sys

from launcher.words import put


class LauncherError(Exception):
    """Why `./course` can't go on, and what to do: a sentence, in the last line of the text."""

    def __init__(self, template: str, **values: object) -> None:
        """Translate the sentence into the user's language."""
        super().__init__(put(template, **values))


def say(template: str, **values: object) -> None:
    """Print a sentence in the user's language; lines before it are output of other programs."""
    *shown, last = put(template, **values).split('\n')
    print(*shown, f'course: {last}', sep='\n', file=sys.stderr, flush=True)


def show_progress(step: str) -> None:
    """Show a step; on a terminal, it replaces the previous one."""
    if sys.stderr.isatty():
        print(f'\r\033[K  {step:.72}', end='', file=sys.stderr, flush=True)
    else:
        print(f'  {step}', file=sys.stderr, flush=True)


def clear_progress() -> None:
    """Remove the last step from a terminal."""
    if sys.stderr.isatty():
        print('\r\033[K', end='', file=sys.stderr, flush=True)
