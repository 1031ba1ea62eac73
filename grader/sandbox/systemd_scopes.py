"""Scopes of systemd: inside a delegated scope, a process can make cgroups."""

import os
import shutil
import subprocess
import uuid
from functools import cache
from pathlib import Path

from grader.sandbox.cgroup_paths import own_paths

UNIT = 'mrb-'
"""Prefix of the scopes made for graders: not every systemd marks the cgroups it delegates."""
SYSTEMD = Path('/run/systemd/system')
"""A folder that exists if systemd is running."""
_TRY_SEC = 10.0


def scope_command() -> tuple[str, ...]:
    """Return the beginning of a command that runs in a new scope."""
    whose = ('--user',) if os.geteuid() else ()
    unit = f'--unit={UNIT}{uuid.uuid4().hex}'
    return ('systemd-run', *whose, '--scope', '--quiet', '--collect', unit, '-pDelegate=yes', '--')


@cache
def has_scopes() -> bool:
    """Try whether systemd makes a scope for this user."""
    lacking = shutil.which('systemd-run') is None or not SYSTEMD.is_dir()
    if lacking or 'memory' in own_paths(Path('/proc/self')):  # version 1: nothing is delegated
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
