"""A folder with every file that is pinned: what is in it, and whether that is enough."""

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
"""Names the folder to install from; `./course --offline FOLDER` sets it."""
CONTENTS = 'contents.json'
"""In the folder, and written last: for each Python, `3.12` say, its files and their SHA-256."""
PYTHONS = ('3.11', '3.12', '3.13')
NAMED = 3
"""How many packages a sentence names."""


@dataclass(frozen=True)
class Wheels:
    """A folder of wheels, and of sources where a package has no wheel."""

    folder: Path
    files: Mapping[str, Mapping[str, str]]
    """For each Python: the SHA-256 of each file by its name."""

    def lacking(self, python: str, pins: Mapping[str, frozenset[str]]) -> list[str]:
        """Return the pins of which there is no file for that Python."""
        there = {
            digest
            for name, digest in self.files.get(python, {}).items()
            if (self.folder / name).is_file()
        }
        return [pin for pin, digests in pins.items() if not digests & there]


def asked_for(variables: Mapping[str, str]) -> Path | None:
    """Return the folder from which to install, if there is to be no network."""
    named = variables.get(VARIABLE, '')
    return Path(named).absolute() if named else None


def read_wheels(folder: Path) -> Wheels:
    """Return what `./course wheels` put into a folder. Raises LauncherError where it is none."""
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
    """Write down what is in the folder, whole or not at all."""
    part = wheels.folder / f'{CONTENTS}.part'
    part.write_text(json.dumps(wheels.files, indent=1, sort_keys=True) + '\n', encoding='utf-8')
    os.replace(part, wheels.folder / CONTENTS)


def read_pins(pins: Path) -> dict[str, frozenset[str]]:
    """Return what environment.txt pins: the SHA-256 of the files that may be installed, by pin."""
    packages = re.split(r'^(?=\w)', pins.read_text(encoding='utf-8'), flags=re.MULTILINE)
    return {
        package.split()[0]: frozenset(re.findall('--hash=sha256:([0-9a-f]{64})', package))
        for package in packages
        if '==' in package
    }


def check_wheels(folder: Path, version: str, pins: Path) -> None:
    """See that a folder has all that a Python, `3.12.1` say, needs. Raises LauncherError."""
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
            packages=in_words(lacks),
            python=python,
        )


def in_words(pins: Iterable[str]) -> str:
    """Return a few of the packages, and how many more there are."""
    pins = list(pins)
    named = ', '.join(pins[:NAMED])
    if len(pins) <= NAMED:
        return named
    return put('{packages} and {count} more', packages=named, count=len(pins) - NAMED)


def sha256_of(file: Path) -> str:
    """Return a file's SHA-256, in hexadecimal."""
    with file.open('rb') as content:
        return hashlib.file_digest(content, 'sha256').hexdigest()
