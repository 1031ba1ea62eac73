"""A folder with all pinned files, to install from: its contents, and whether it is complete."""

import hashlib
import json
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from launcher.messages import LauncherError
from launcher.words import put

VARIABLE = 'COURSE_WHEELS'
"""The variable with the folder to install from; `./course --offline FOLDER` sets it."""
CONTENTS = 'contents.json'
"""A file in the folder, written last: for each Python, such as `3.12`, files and their SHA-256."""
PYTHONS = ('3.11', '3.12', '3.13')
NAMED = 3
"""How many packages a message names."""


@dataclass(frozen=True)
class Wheels:
    """A folder of wheels, and of source archives for packages without a wheel."""

    folder: Path
    files: Mapping[str, Mapping[str, str]]
    """For each Python: the SHA-256 of each file, by file name."""

    def lacking(self, python: str, pins: Mapping[str, frozenset[str]]) -> list[str]:
        """Return the pins that have no file for that Python in the folder."""
        there = {
            digest
            for name, digest in self.files.get(python, {}).items()
            if (self.folder / name).is_file()
        }
        return [pin for pin, digests in pins.items() if not digests & there]


def offline_wheels(variables: Mapping[str, str]) -> Path | None:
    """Return the folder to install from without a network; None if the network may be used."""
    named = variables.get(VARIABLE, '')
    return Path(named).absolute() if named else None


def read_wheels(folder: Path) -> Wheels:
    """Read the folder that `./course wheels` made. Raises LauncherError if it did not."""
    try:
        files = json.loads((folder / CONTENTS).read_text(encoding='utf-8'))
    except (OSError, ValueError):
        raise LauncherError(
            '{folder} has no {contents} that can be read, which ./course wheels writes last: '
            'make the folder with ./course wheels FOLDER on a machine with a network, and copy '
            'all of it.',
            folder=folder,
            contents=CONTENTS,
        ) from None
    return Wheels(folder, files)


def write_wheels(wheels: Wheels) -> None:
    """Record the folder's contents in a file, written atomically."""
    part = wheels.folder / f'{CONTENTS}.part'
    part.write_text(json.dumps(wheels.files, indent=1, sort_keys=True) + '\n', encoding='utf-8')
    os.replace(part, wheels.folder / CONTENTS)


def read_pins(pins: Path) -> dict[str, frozenset[str]]:
    """Return the pins of environment.txt, each with the SHA-256 of the files it allows."""
    packages = re.split(r'^(?=\w)', pins.read_text(encoding='utf-8'), flags=re.MULTILINE)
    return {
        package.split()[0]: frozenset(re.findall('--hash=sha256:([0-9a-f]{64})', package))
        for package in packages
        if '==' in package
    }


def check_wheels(folder: Path, version: str, pins: Path) -> None:
    """Check that a folder has all that a Python, such as `3.12.1`, needs. Raises LauncherError."""
    wheels, python = read_wheels(folder), version.rpartition('.')[0]
    if python not in wheels.files:
        raise LauncherError(
            '{folder} is for Python {pythons}, and this one is {version}: name another Python '
            '(PYTHON=/path/to/python3 ./course …), or make the folder with ./course wheels '
            '--python {python} FOLDER.',
            folder=folder,
            pythons=', '.join(sorted(wheels.files)),
            version=version,
            python=python,
        )
    if lacks := wheels.lacking(python, read_pins(pins)):
        raise LauncherError(
            '{folder} lacks {packages} for Python {python}: it was made for another version of '
            'the course, or not all of it was copied. Make it again with ./course wheels FOLDER, '
            'from the same version of the course.',
            folder=folder,
            packages=summarize_pins(lacks),
            python=python,
        )


def summarize_pins(pins: Iterable[str]) -> str:
    """Return the first of the packages, and how many more there are."""
    pins = list(pins)
    named = ', '.join(pins[:NAMED])
    if len(pins) <= NAMED:
        return named
    return put('{packages} and {count} more', packages=named, count=len(pins) - NAMED)


def sha256_of(file: Path) -> str:
    """Return a file's SHA-256, in hexadecimal."""
    with file.open('rb') as content:
        return hashlib.file_digest(content, 'sha256').hexdigest()
