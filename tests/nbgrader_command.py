"""nbgrader's own commands, run in a course's folder with an exchange beside it."""

import os
import subprocess
import sys
from pathlib import Path


def run_nbgrader(command, assignment, *, course, exchange, options=()):
    """Run a command about an assignment in the exchange of the course `robots`."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    where = ['--course=robots', f'--Exchange.root={exchange}', *options]
    return subprocess.run(
        [sys.executable, '-m', 'nbgrader', command, assignment, *where],
        cwd=course.root,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ | {'PATH': path},
        timeout=120,
    )
