"""A terminal of the course in which colcon builds packages."""

import os
import subprocess
import sys
from pathlib import Path

BIN = Path(sys.prefix, 'bin')
PATIENCE_SEC = 300


def bash(folder, script, **environment):
    """Run a script in the workspace, in a terminal of the course."""
    own = {name: os.environ[name] for name in os.environ if not name.startswith('_ROS_')}
    own['PATH'] = f'{BIN}:{own["PATH"]}'
    own.pop('LD_LIBRARY_PATH', None)
    if ' ' in sys.executable:
        own['COLCON_PYTHON_EXECUTABLE'] = str(Path(sys.executable).resolve())
    return subprocess.run(
        ['/bin/bash', '-c', script],
        cwd=folder,
        env=own | {'ROS_WS': str(folder), 'AMENT_PREFIX_PATH': sys.prefix} | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding='utf-8',
        timeout=PATIENCE_SEC,
    )
