"""Pin what the hub and its servers need, with hashes: `.venv/bin/python deploy/jupyterhub/pin.py`.

It writes hub.txt and server.txt; server.txt omits what environment.txt has. The proxy is pinned in
package-lock.json, by `npm install --package-lock-only --omit-lockfile-registry-resolved`.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
COURSE = HERE.parents[1] / 'environment.txt'
WHOLE_PIN = re.compile(r'^(?=\w)', re.MULTILINE)
"""Matches the beginning of each pin, which includes its lines of hashes."""


def main() -> None:
    """Write both files."""
    in_course = {name_of(pin) for pin in pins_in(COURSE.read_text(encoding='utf-8'))}
    (HERE / 'hub.txt').write_text(''.join(resolve('hub.in')), encoding='utf-8')
    pins = [pin for pin in resolve('server.in', COURSE) if name_of(pin) not in in_course]
    (HERE / 'server.txt').write_text(''.join(pins), encoding='utf-8')


def pins_in(text: str) -> list[str]:
    """Return each pin of a requirements file, with its hashes."""
    return [part for part in WHOLE_PIN.split(text) if '==' in part.partition('\n')[0]]


def name_of(pin: str) -> str:
    """Return the name of the package in a pin."""
    return pin.partition('==')[0]


def resolve(wanted: str, constraints: Path | None = None) -> list[str]:
    """Return the pins that uv finds for a file, constrained to the versions in another file."""
    uv = [Path(sys.prefix, 'bin/uv'), 'pip', 'compile', '--quiet', '--universal', wanted]
    uv += ['--python-version', '3.11', '--generate-hashes', '--no-header', '--no-annotate']
    with tempfile.NamedTemporaryFile('w', suffix='.txt') as file:
        if constraints:
            lines = pins_in(constraints.read_text(encoding='utf-8'))
            file.writelines(f'{pin.split()[0]}\n' for pin in lines)
            file.flush()
            uv += ['--constraints', file.name]
        found = subprocess.run(uv, cwd=HERE, check=True, stdout=subprocess.PIPE, text=True)
    return pins_in(found.stdout)


if __name__ == '__main__':
    main()
