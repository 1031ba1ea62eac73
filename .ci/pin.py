"""Write environment.txt from pyproject.toml, by `.venv/bin/python .ci/pin.py [--upgrade]`.

Each pin has the hashes of the files that may be installed: for each supported Python, the wheels
that uv finds for manylinux on x86-64, or the source where there is none. The first section is what
students get, the second what only the whole course needs. Without --upgrade, versions stay.
"""

import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PYTHONS = ('3.11', '3.12', '3.13')
STUDENTS = '# --- what the lessons run on: this part is in the bundle for students ---'
COURSE = '# --- what only the whole course needs: its tests, and grading on several machines ---'
HEADER = """\
# Every dependency, pinned, with the hashes of its files for CPython 3.11 to 3.13 on Linux x86-64.
# Made by .ci/pin.py from what `uv pip compile` finds for pyproject.toml.
"""


def main(arguments: list[str]) -> None:
    """Resolve both parts, and write the file."""
    pins = ROOT / 'environment.txt'
    kept = [] if '--upgrade' in arguments else ['--constraints', without_hashes(pins)]
    everything = resolve(kept, '--all-extras')
    needed = resolve(kept).keys()
    lines = [HEADER, STUDENTS + '\n']
    lines += [pin for name, pin in sorted(everything.items()) if name in needed]
    lines += [COURSE + '\n']
    lines += [pin for name, pin in sorted(everything.items()) if name not in needed]
    pins.write_text(''.join(lines), encoding='utf-8')


def without_hashes(pins: Path) -> str:
    """Write the pins alone to a temporary file; return its path."""
    lines = pins.read_text(encoding='utf-8').splitlines()
    with tempfile.NamedTemporaryFile('w', suffix='.txt', delete=False) as file:
        file.writelines(f'{line.split()[0]}\n' for line in lines if line[:1].isalnum())
    return file.name


def resolve(kept: list[str], *options: str) -> dict[str, str]:
    """Return each package's lines: its pin, and a hash for each file that a Python would take."""
    versions, hashes = {}, {}
    for python in PYTHONS:
        for package in locked(python, kept, *options):
            name, version = package['name'], package['version']
            if versions.setdefault(name, version) != version:
                raise SystemExit(
                    f'{name} is {versions[name]} for {PYTHONS[0]}, {version} for {python}'
                )
            for file in package.get('wheels') or [package['sdist']]:
                hashes.setdefault(name, set()).add(file['hashes']['sha256'])
    return {name: in_lines(name, versions[name], hashes[name]) for name in versions}


def in_lines(name: str, version: str, hashes: set[str]) -> str:
    """Return a requirement with its hashes, as pip and uv read it."""
    return (
        ' \\\n    '.join(
            [f'{name}=={version}', *(f'--hash=sha256:{each}' for each in sorted(hashes))]
        )
        + '\n'
    )


def locked(python: str, kept: list[str], *options: str) -> list[dict]:
    """Return the packages that uv chooses for a Python, with their files."""
    # a set of versions for the oldest Python fits the others
    wanted = ('--python-version', python, '--python-platform', 'x86_64-manylinux_2_28')
    with tempfile.TemporaryDirectory() as folder:
        lock = Path(folder, 'pylock.toml')
        uv = [Path(sys.prefix, 'bin/uv'), 'pip', 'compile', '--quiet', '--generate-hashes']
        # what ROS's wheels set for this Python must not reach another one's libraries
        variables = {k: v for k, v in os.environ.items() if k != 'LD_LIBRARY_PATH'}
        command = [*uv, *wanted, *kept, *options, '--format', 'pylock.toml', '-o', lock]
        subprocess.run([*command, 'pyproject.toml'], cwd=ROOT, env=variables, check=True)
        return tomllib.loads(lock.read_text(encoding='utf-8'))['packages']


if __name__ == '__main__':
    main(sys.argv[1:])
