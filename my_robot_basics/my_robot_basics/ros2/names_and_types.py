"""Shared code of the verbs `list`, `find` and `type` of topics, services and actions."""

import argparse
from collections.abc import Sequence

NamesAndTypes = Sequence[tuple[str, list[str]]]


def add_list_options(parser: argparse.ArgumentParser, noun: str) -> None:
    """Add the options of `ros2 NOUN list`."""
    parser.add_argument(
        '-t', '--show-types', action='store_true', help=f'Additionally show the {noun} type'
    )
    add_count(parser, noun)


def add_count(parser: argparse.ArgumentParser, noun: str) -> None:
    """Add the option `--count-NOUNs`."""
    parser.add_argument(
        '-c',
        f'--count-{noun}s',
        dest='count',
        action='store_true',
        help=f'Only display the number of {noun}s discovered',
    )


def print_list(found: NamesAndTypes, *, count: bool, show_types: bool = False) -> None:
    """Print the names, with `show_types` also their types; or with `count` how many there are."""
    if count:
        print(len(found))
        return
    for name, types in found:
        print(f'{name} [{", ".join(types)}]' if show_types else name)


def print_with_type(found: NamesAndTypes, type_name: str, *, count: bool) -> None:
    """Print the names with that type, or with `count` how many there are."""
    print_list([each for each in found if type_name in each[1]], count=count)


def print_types(found: NamesAndTypes, name: str) -> int:
    """Print the types of a name; return the exit status, 1 if the name is not on the graph."""
    types = dict(found).get(name)
    if types is None:
        return 1
    print(*types, sep='\n')
    return 0
