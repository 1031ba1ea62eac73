"""What it costs to store a graded submission, for the first time and once more.

    .venv/bin/python tests/benchmarks/storing.py GRADEBOOK [--against FOLDER] [--rounds 3]

GRADEBOOK is a graded one, as class_of_500.py leaves it: its graded notebooks are stored into an
empty one. FOLDER is the working copy of an earlier commit with its own .venv: both store all
notebooks in turn, so that they run under the same conditions, and the stored scores, comments and
notebooks are compared. The exit status is 1 if they differ.
"""

import argparse
import hashlib
import json
import os
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIRST, MORE = 'first', 'once more'
ROWS = """
select student.id, assignment.name, base_cell.name, auto_score, manual_score, extra_credit,
    needs_manual_grade, timestamp, late_submission_penalty, null, null
from grade join base_cell on base_cell.id = grade.cell_id
    join submitted_notebook on submitted_notebook.id = grade.notebook_id
    join submitted_assignment on submitted_assignment.id = submitted_notebook.assignment_id
    join assignment on assignment.id = submitted_assignment.assignment_id
    join student on student.id = submitted_assignment.student_id
union all
select student.id, assignment.name, base_cell.name, null, null, null, null, null, null,
    auto_comment, manual_comment
from comment join base_cell on base_cell.id = comment.cell_id
    join submitted_notebook on submitted_notebook.id = comment.notebook_id
    join submitted_assignment on submitted_assignment.id = submitted_notebook.assignment_id
    join assignment on assignment.id = submitted_assignment.assignment_id
    join student on student.id = submitted_assignment.student_id
order by 1, 2, 3, 4
"""


def main(source: Path, against: Path | None, rounds: int) -> int:
    """Print a row for each working copy; return 1 if what they have stored differs."""
    taken: dict[tuple[Path, str], list[tuple[float, float]]] = {}
    stored: set[str] = set()
    roots = [ROOT, *([against] if against else [])]
    for _ in range(rounds):
        for root in roots:
            found = _in_its_own_process(root, source)
            stored.add(found['stored'])
            for when in (FIRST, MORE):
                taken.setdefault((root, when), []).extend(found[when])
    print(f'{"median of a submission, in ms":32} {"CPU":>7} {"wall":>7}')
    for (root, when), each in taken.items():
        cpu, wall = (1000 * statistics.median(column) for column in zip(*each, strict=True))
        print(f'{when + (" here" if root == ROOT else " there"):32} {cpu:7.1f} {wall:7.1f}')
    print('All have stored the same' if len(stored) == 1 else 'What they have stored differs')
    return 0 if len(stored) == 1 else 1


def _in_its_own_process(root: Path, source: Path) -> dict:
    command = [root / '.venv/bin/python', '-P', __file__, source, '--only', root]
    path = f'{root}/.venv/bin:{os.environ["PATH"]}'
    ran = subprocess.run(
        list(map(str, command)),
        cwd=root,
        env=os.environ | {'PATH': path},
        stdout=subprocess.PIPE,
        check=True,
    )
    return json.loads(ran.stdout)


def store_all(root: Path, source: Path) -> dict:
    """Store all graded notebooks of a gradebook into an empty one, with `root`'s grader."""
    sys.path[:0] = [str(root)]
    import nbformat

    from grader.course import Course
    from grader.notebook.submission import read_submission
    from grader.storage.database import share_engine
    from grader.storage.gradebook import store
    from grader.storage.lock import gradebook_lock
    from grader.storage.registering import register_all

    theirs = Course(gradebook=source)
    with tempfile.TemporaryDirectory(prefix='storing-') as folder:
        course = Course(gradebook=Path(folder, 'gradebook'))
        register_all(course)
        work = []
        for path in sorted(source.glob('autograded/*/*/*.ipynb')):
            student, assignment = path.parts[-3:-1]
            submission = read_submission(
                theirs.folder('submitted', student, assignment),
                student_id=student,
                assignment=assignment,
                packages=course.packages(assignment),
            )
            work.append((submission, path))
        taken: dict[str, list[tuple[float, float]]] = {FIRST: [], MORE: []}
        with share_engine(course.db_url):
            for each in taken.values():
                for submission, path in work:
                    graded = nbformat.read(path, as_version=4)
                    cpu, wall = time.process_time(), time.perf_counter()
                    with gradebook_lock(course.gradebook):
                        store(course, submission, graded)
                    each.append((time.process_time() - cpu, time.perf_counter() - wall))
        return taken | {'stored': _digest(course.gradebook)}


def _digest(gradebook: Path) -> str:
    whole = hashlib.sha256()
    with sqlite3.connect(gradebook / 'gradebook.db') as database:
        whole.update(json.dumps(list(database.execute(ROWS))).encode())
    for path in sorted(gradebook.glob('autograded/**/*')):
        if path.is_file():
            whole.update(f'{path.relative_to(gradebook)}'.encode() + path.read_bytes())
    return whole.hexdigest()


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('source', type=Path, metavar='GRADEBOOK')
    parser.add_argument('--against', type=Path, metavar='FOLDER')
    parser.add_argument('--rounds', type=int, default=3)
    parser.add_argument('--only', type=Path, help=argparse.SUPPRESS)
    args = parser.parse_args()
    gradebook = args.source.resolve()
    if args.only:
        print(json.dumps(store_all(args.only, gradebook)))
        sys.exit()
    sys.exit(main(gradebook, args.against and args.against.resolve(), args.rounds))
