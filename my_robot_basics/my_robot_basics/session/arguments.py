"""The command line of a student's `./course` verb, with help and errors in their language."""

import argparse
import sys
from typing import Any, NoReturn

from my_robot_basics.language.speaking import in_language_here

TO_SHOW: tuple[str, ...] = (
    *('usage: ', 'positional arguments:', 'options:', 'show this help and exit'),
    'the following arguments are required: {names}',
    'unrecognized arguments: {words}',
    'argument {option}: expected one argument',
    'argument {option}: invalid choice: {word} (choose from {words})',
)
"""What argparse itself says."""
HEADINGS = TO_SHOW[:3]


class Arguments(argparse.ArgumentParser):
    """An ArgumentParser that speaks the user's language."""

    def __init__(self, prog: str, **options: Any) -> None:
        """Take the options of ArgumentParser; texts among them are translated already."""
        super().__init__(prog, add_help=False, **options)
        about = in_language_here('show this help and exit')
        self.add_argument('-h', '--help', action='help', help=about)

    def format_usage(self) -> str:
        """Return how the verb is called."""
        return _translated(super().format_usage())

    def format_help(self) -> str:
        """Return the whole help."""
        return _translated(super().format_help())

    def error(self, message: str) -> NoReturn:
        """Print how the verb is called and what is wrong, and exit with 2."""
        self.print_usage(sys.stderr)
        self.exit(2, f'{self.prog}: {in_language_here(f"error: {message}")}\n')


def _translated(text: str) -> str:
    """Translate the headings in the text that argparse has made."""
    lines = text.split('\n')
    for at, line in enumerate(lines):
        for heading in HEADINGS:
            if line == heading or (heading[-1] == ' ' and line.startswith(heading)):
                lines[at] = in_language_here(heading) + line.removeprefix(heading)
    return '\n'.join(lines)
