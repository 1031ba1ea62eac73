"""What `./course` says to a person: on stderr, in sentences."""

import sys

from launcher.words import put


class LauncherError(Exception):
    """The reason why nothing can be done, and what to do: one sentence, the last of its lines."""

    def __init__(self, template: str, **values: object) -> None:
        """Put it in the user's language."""
        super().__init__(put(template, **values))


def say(template: str, **values: object) -> None:
    """Print a sentence in the user's language; lines before it are somebody else's words."""
    *shown, last = put(template, **values).split('\n')
    print(*shown, f'course: {last}', sep='\n', file=sys.stderr, flush=True)


def show_progress(step: str) -> None:
    """Show a step: in a terminal it replaces the one before."""
    if sys.stderr.isatty():
        print(f'\r\033[K  {step:.72}', end='', file=sys.stderr, flush=True)
    else:
        print(f'  {step}', file=sys.stderr, flush=True)


def clear_progress() -> None:
    """Take the last step away from a terminal."""
    if sys.stderr.isatty():
        print('\r\033[K', end='', file=sys.stderr, flush=True)
