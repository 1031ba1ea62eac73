"""Simulate a machine on which this course was never used."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
KEPT = ('LANG', 'http_proxy', 'https_proxy', 'no_proxy', 'SSL_CERT_FILE', 'PIP_CONFIG_FILE')
KEPT += ('HTTP_PROXY', 'HTTPS_PROXY', 'PIP_INDEX_URL', 'UV_INDEX_URL', 'UV_DEFAULT_INDEX')
COMPILERS = re.compile(
    r'(.*-)?(cc|gcc|c\+\+|g\+\+|cpp|clang|clang\+\+|c[89]9|make|gmake|cmake|ninja)(-[\d.]+)?'
)


def programs_without_compilers(folder: Path) -> Path:
    """Return a new folder with links to this machine's programs, but not to compilers."""
    folder.mkdir()
    for place in ('/usr/local/bin', '/usr/bin', '/bin'):
        for program in Path(place).iterdir():
            link = folder / program.name
            if not COMPILERS.fullmatch(program.name) and not os.path.lexists(link):
                link.symlink_to(program)
    return folder


def fresh_clone(folder: Path) -> Path:
    """Return a new folder with all tracked files of the course, and no generated ones."""
    tracked = subprocess.run(['git', 'ls-files', '-z'], cwd=ROOT, capture_output=True, check=True)
    for name in tracked.stdout.decode().split('\0')[:-1]:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)
    return folder


def fresh_environment(folder: Path) -> dict[str, str]:
    """Return the environment of a fresh machine: no .venv, no compiler, a home in `folder`."""
    home, tools = folder / 'home', folder / 'tools'
    home.mkdir()
    tools.mkdir()
    (tools / 'python3').symlink_to(sys._base_executable)
    environment = {name: os.environ[name] for name in KEPT if name in os.environ}
    programs = programs_without_compilers(folder / 'programs')
    environment |= {'HOME': str(home), 'PATH': f'{tools}:{programs}'}
    for name in ('.config/pip/pip.conf', '.pip/pip.conf'):  # how this machine reaches a registry
        if (there := Path.home() / name).is_file():
            (home / name).parent.mkdir(parents=True)
            shutil.copy(there, home / name)
    return environment
