"""`./course wheels [--python 3.11,3.12,3.13] FOLDER`: all that a machine without network needs.

pip downloads exactly the files that environment.txt pins; `./course --offline FOLDER` installs
them.
"""

import argparse
import os
import tempfile
from pathlib import Path

from launcher.environment import Environment
from launcher.installer import FULL, Installer, report_write_errors
from launcher.messages import LauncherError, say
from launcher.offline import (
    CONTENTS,
    PYTHONS,
    VARIABLE,
    Wheels,
    read_pins,
    read_wheels,
    sha256_of,
    summarize_pins,
    write_wheels,
)
from launcher.set_up import locked
from launcher.venv_inputs import PINS

PLATFORMS: tuple[str, ...] = ('manylinux1_x86_64', 'manylinux2010_x86_64', 'manylinux2014_x86_64')
PLATFORMS += tuple(f'manylinux_2_{minor}_x86_64' for minor in range(5, 29))
"""The platform tags for glibc 2.28, which the ROS packages need: pip requires each one's name."""


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Fill the folder; return the exit status."""
    parser = argparse.ArgumentParser(
        prog='./course wheels',
        description='Make a folder from which ./course --offline FOLDER installs.',
    )
    parser.add_argument('folder', type=Path, metavar='FOLDER', help='a new or an empty folder')
    parser.add_argument(
        '--python',
        type=pythons,
        default=list(PYTHONS),
        metavar='VERSIONS',
        help=f'for which Pythons, {",".join(PYTHONS)} unless you say it',
    )
    asked = parser.parse_args(arguments)
    if variables.get(VARIABLE):
        raise LauncherError('./course wheels downloads packages: start it without --offline.')
    with report_write_errors(), locked(environment.root) as lock:
        wheels = fill(environment, lock, asked.folder.absolute(), asked.python)
    size = sum((wheels.folder / name).stat().st_size for name in names_in(wheels))
    say(
        '{folder} has {count} files, {size_mb:.0f} MB, for Python {pythons}: copy it to the other '
        'machine with the course, and start ./course --offline FOLDER lab there',
        folder=wheels.folder,
        count=len(names_in(wheels)),
        size_mb=size / 1e6,
        pythons=', '.join(wheels.files),
    )
    return 0


def fill(environment: Environment, lock: int, folder: Path, versions: list[str]) -> Wheels:
    """Download the files for each Python; return the folder's contents.

    Raises LauncherError if the folder has other files, or if a file can't be downloaded.
    """
    before = read_earlier_download(folder)
    installer = Installer(environment, environment.variables_for_installers(os.environ), lock)
    files: dict[str, dict[str, str]] = {}
    for version in versions:
        say(
            'downloading the wheels for Python {version} (some minutes the first time)',
            version=version,
        )
        files[version] = download(installer, folder, version)
    wheels = Wheels(folder, files)
    for old in names_in(before) - names_in(wheels):
        (folder / old).unlink(missing_ok=True)
    write_wheels(wheels)
    return wheels


def read_earlier_download(folder: Path) -> Wheels:
    """Return what an earlier call put there; make the folder if there is none.

    Raises LauncherError if it can't be made, or has other files.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        if error.errno in FULL:
            raise
        raise LauncherError(
            '{folder} cannot be made ({reason}): name another folder, a new or an empty one.',
            folder=folder,
            reason=error.strerror,
        ) from None
    if (folder / CONTENTS).exists():
        return read_wheels(folder)
    if any(
        each for each in folder.iterdir() if not each.name.endswith(('.whl', '.tar.gz', '.part'))
    ):
        raise LauncherError(
            '{folder} is not empty and was not made by ./course wheels: name a new folder.',
            folder=folder,
        )
    return Wheels(folder, {})


def download(installer: Installer, folder: Path, version: str) -> dict[str, str]:
    """Put all pinned files for a Python into the folder; return their SHA-256 by name."""
    root = installer.environment.root
    platforms = [option for name in PLATFORMS for option in ('--platform', name)]
    with tempfile.TemporaryDirectory(dir=folder, suffix='.part') as part:
        installer.run(
            *(installer.environment.python, '-m', 'pip', 'download', '--no-input'),
            *('--disable-pip-version-check', '--progress-bar', 'off', '--no-deps'),
            *('--no-build-isolation', '--python-version', version, *platforms),
            *('--require-hashes', '-r', PINS, '-d', part),
        )
        found = {file.name: sha256_of(file) for file in sorted(Path(part).iterdir())}
        pins = read_pins(root / PINS)
        lacks = [pin for pin, digests in pins.items() if not digests & {*found.values()}]
        if lacks:
            raise LauncherError(
                'pip brought no file of {packages} for Python {version}: start again, and report '
                'it if that does not help.',
                packages=summarize_pins(lacks),
                version=version,
            )
        for name in found:
            os.replace(Path(part) / name, folder / name)
    return found


def names_in(wheels: Wheels) -> set[str]:
    """Return the names of all files."""
    return {name for files in wheels.files.values() for name in files}


def pythons(text: str) -> list[str]:
    """Parse the versions of an argument; argparse shows the error."""
    versions = list(dict.fromkeys(text.split(',')))
    if unknown := [version for version in versions if version not in PYTHONS]:
        raise argparse.ArgumentTypeError(
            f'{unknown[0]!r} is not among {", ".join(PYTHONS)}, for which the packages exist'
        )
    return versions
