"""The table of the verbs; `course` reads the same file for `--help`."""

import os

TABLE = os.path.join(os.path.dirname(__file__), 'verbs.txt')


class Verb:
    """A row of the table."""

    def __init__(self, name: str, owner: str, runs: str, folder: str, explained: str) -> None:
        """Take the fields of the row."""
        self.name = name
        self.owner = owner
        """`everyone`, or `course` if it needs the whole repository."""
        self.runs = runs
        """A module such as `launcher.lab`, or else the arguments after `python -P -m`."""
        self.folder = folder
        """`root`: the course's root folder; `caller`: the folder where ./course was called."""
        self.help = explained
        """Its help, in one line."""


def read_verbs(table: str | os.PathLike[str] = TABLE) -> dict[str, Verb]:
    """Return the verbs by name, in the order of the table.

    Raises ValueError if a row does not have the form that the table's first lines describe.
    """
    verbs = {}
    with open(table, encoding='utf-8') as file:
        lines = file.read().splitlines()
    for line in lines:
        owner, runs, folder, text = line.split('|', 3) if line[:1] not in '#' else [''] * 4
        if not owner:
            continue
        if owner not in ('everyone', 'course') or folder not in ('root', 'caller'):
            raise ValueError(f'{table}: not a verb, its owner and its folder: {line}')
        usage, _, explained = text.partition('  ')
        name = usage.split()[0]
        verbs[name] = Verb(name, owner, runs, folder, explained.strip())
    return verbs
