"""Run stock `nbgrader autograde` in the sandbox of attacks_against_stock.py.

    stock_autograde.py COURSE ASSIGNMENT PORT

It copies the course beside this file to COURSE, grades, and prints one line of JSON: the points by
student, the attacker's graded notebooks, and what was left behind.
"""

import json
import os
import shutil
import socket
import subprocess
import sys
from pathlib import Path

ATTACKER = 'a-attacker'
LEFT = ('loaded_by_the_grader', 'evil_kernel', 'slipped')
LIMIT_SEC = 280


def main(course: Path, assignment: str, port: int) -> None:
    """Grade, and print the results."""
    shutil.copytree(Path(__file__).with_name('course'), course, symlinks=True)
    subprocess.run(['chmod', '-R', 'u+w', str(course)], check=True)
    with socket.create_server(('127.0.0.1', port)) as server:
        server.setblocking(False)
        before = _processes()
        command = [sys.executable, '-P', '-m', 'nbgrader', 'autograde', assignment]
        quiet = dict.fromkeys(('stdin', 'stdout', 'stderr'), subprocess.DEVNULL)
        subprocess.run(command, cwd=course, timeout=LIMIT_SEC, check=False, **quiet)
        left = ['a process'] * bool(_processes() - before)
        left += ['a file'] * any(Path('/tmp', name).exists() for name in LEFT)
        try:
            server.accept()[0].close()
            left.append('a connection')
        except BlockingIOError:
            pass
    graded = sorted((course / 'autograded' / ATTACKER).glob('*/*.ipynb'))
    told = {
        'points': _points(course, assignment),
        'notebooks': [path.read_text(encoding='utf-8') for path in graded],
        'left': left,
    }
    print()
    print(json.dumps(told))


def _processes() -> set[str]:
    return {name for name in os.listdir('/proc') if name.isdigit()} - {str(os.getpid())}


def _points(course: Path, assignment: str) -> dict[str, float]:
    """Return the stored score of each student whose notebook was graded."""
    from nbgrader.api import Gradebook

    with Gradebook(f'sqlite:///{course}/gradebook.db') as gradebook:
        return {
            submission.student_id: submission.score
            for submission in gradebook.assignment_submissions(assignment)
            if (course / 'autograded' / submission.student_id / assignment).is_dir()
        }


if __name__ == '__main__':
    main(Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]))
