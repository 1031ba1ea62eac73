"""Types of arguments of `./course`, with messages for invalid ones."""

import argparse
from collections.abc import Callable, Sequence
from datetime import datetime

from grader.cli.verbs import NO_DATE
from grader.common.argument_values import RECORDED, local_time

AddVerb = Callable[..., argparse.ArgumentParser]
"""Takes a verb's name and its `help`; returns the parser of its arguments."""


class VerbParser(argparse.ArgumentParser):
    """Refuses arguments that a verb does not know, and shows only this verb's usage.

    An option may be between two others: argparse alone would take `due ASSIGNMENT --student ID
    DATE` for a command without a date, and call the date unknown.
    """

    _parses_again = False

    def parse_known_args(  # type: ignore[override]  # argparse gives it no other namespace
        self,
        args: Sequence[str] | None = None,
        namespace: argparse.Namespace | None = None,
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse the arguments; exit with status 2 if some are unknown."""
        found, left = super().parse_known_args(args, namespace)
        if self._parses_again:  # called by parse_known_intermixed_args, which goes on with `left`
            return found, left
        if left:
            self._parses_again = True
            try:
                found, left = self.parse_known_intermixed_args(args, namespace)
            finally:
                self._parses_again = False
        if left:
            self.error(f'unrecognized arguments: {" ".join(left)}')
        return found, left


def hexadecimal(text: str) -> str:
    """Check an argument; argparse shows what this raises."""
    try:
        if text != RECORDED:
            int(text, 16)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f'{text!r} is neither a hexadecimal number nor {RECORDED}'
        ) from None
    return text


def date(text: str) -> datetime | str:
    """Check an argument; argparse shows what this raises."""
    try:
        return text if text == NO_DATE else local_time(text)
    except (ValueError, OverflowError):
        raise argparse.ArgumentTypeError(
            f'{text!r} is not a date: write 2026-11-30, or none'
        ) from None


def at_least_one(text: str) -> int:
    """Check an argument; argparse shows what this raises."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'{text!r} is not a number from 1 on')
    return int(text)
