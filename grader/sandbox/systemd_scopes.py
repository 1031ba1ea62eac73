"""Scopes of systemd: where it is asked for one, cgroups can be made in it."""

import os
import shutil
import subprocess
import uuid
from functools import cache
from pathlib import Path

from grader.sandbox.cgroup_paths import own_paths

UNIT = 'mrb-'
"""How a scope is called that is for graders alone: not every systemd marks what it delegates."""
SYSTEMD = Path('/run/systemd/system')
"""It is there where systemd runs."""
_TRY_SEC = 10.0


def scope_command() -> tuple[str, ...]:
    """Return how a command begins that runs in a new scope."""
    whose = ('--user',) if os.geteuid() else ()
    unit = f'--unit={UNIT}{uuid.uuid4().hex}'
    return ('systemd-run', *whose, '--scope', '--quiet', '--collect', unit, '-pDelegate=yes', '--')


@cache
def has_scopes() -> bool:
    """Try whether systemd makes a scope for us."""
    lacking = shutil.which('systemd-run') is None or not SYSTEMD.is_dir()
    if lacking or 'memory' in own_paths(Path('/proc/self')):  # of version 1: it has none to give
        return False
    try:
        tried = subprocess.run(
            [*scope_command(), 'true'],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_TRY_SEC,
        )
    except subprocess.TimeoutExpired:
        return False
    return tried.returncode == 0
