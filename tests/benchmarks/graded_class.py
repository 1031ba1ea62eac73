"""What a class that is graded takes: `./course grade` without anything new, and `feedback`.

    .venv/bin/python tests/benchmarks/graded_class.py grade GRADEBOOK [--against FOLDER]
    .venv/bin/python tests/benchmarks/graded_class.py feedback GRADEBOOK [--rounds 3]

GRADEBOOK is a graded one, as class_of_500.py leaves it. In a copy of it, results are marked as
made by this very grader. FOLDER is the working copy of an earlier commit with its own .venv: it
has a copy, too, and runs alternate between both, so that they run under the same conditions. CPU
is that of all processes that were waited for. The exit status is 1 if the tables or the pages
differ.
"""

import argparse
import hashlib
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VERB = """
import sys
from pathlib import Path
from grader.__main__ import main
from grader.course import Course
sys.exit(main([sys.argv[2]], course=Course(gradebook=Path(sys.argv[1]))))
"""
OF_THIS_GRADER = """
import sys
from pathlib import Path
import nbformat
from grader.course import Course
from grader.kernels.isolation import require_isolation
from grader.notebook.submission import read_submission
from grader.storage.reuse import conditions_digest, files_digest, key_of, write_key
from grader.storage.seeds import seeds
course = Course(gradebook=Path(sys.argv[1]))
known = {}
for path in sorted(course.gradebook.glob('autograded/*/*/*.ipynb')):
    student, name = path.parts[-3:-1]
    if name not in known:
        isolated = require_isolation(trust_students=True)
        known[name] = conditions_digest(course, name, isolated=isolated), seeds(course, name)
    given, seed = known[name]
    submission = read_submission(
        course.folder('submitted', student, name), student_id=student, assignment=name,
        packages=course.packages(name),
    )
    graded = nbformat.read(path, as_version=4)
    write_key(graded, key_of(submission, given, seed=seed(submission)), files_digest(submission))
    nbformat.write(graded, path)
"""


def main(verb: str, source: Path, against: Path | None, rounds: int) -> int:
    """Print a row for each working copy; return 1 if their tables differ."""
    taken: dict[Path, list[tuple[float, float]]] = {}
    said: set[str] = set()
    with tempfile.TemporaryDirectory(prefix='graded_class-') as folder:
        roots = [ROOT, *([against] if against else [])]
        gradebooks = {root: Path(folder, f'{n}', 'gradebook') for n, root in enumerate(roots)}
        for root, gradebook in gradebooks.items():
            shutil.copytree(source, gradebook, ignore=shutil.ignore_patterns('feedback', 'runs'))
            _run(root, OF_THIS_GRADER, gradebook)
        for _ in range(rounds):
            for root, gradebook in gradebooks.items():
                shutil.rmtree(gradebook / 'feedback', ignore_errors=True)
                before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
                table = _run(root, VERB, gradebook, verb)
                wall = time.perf_counter() - began
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                taken.setdefault(root, []).append((wall, cpu))
                table = table.replace(str(gradebook), '').partition('Report:')[0]
                said.add(table + _digest(gradebook / 'feedback'))
    print(f'{"median, in seconds":24} {"wall":>7} {"CPU":>7}')
    for root, each in taken.items():
        wall, cpu = (statistics.median(column) for column in zip(*each, strict=True))
        print(f'{"here" if root == ROOT else "there":24} {wall:7.2f} {cpu:7.2f}')
    print('All have said the same' if len(said) == 1 else 'What they have said differs')
    return 0 if len(said) == 1 else 1


def _digest(pages: Path) -> str:
    whole = hashlib.sha256()
    for path in sorted(pages.glob('*/*/*')):
        whole.update(f'{path.relative_to(pages)}'.encode() + path.read_bytes())
    return whole.hexdigest()


def _run(root: Path, code: str, gradebook: Path, *arguments: str) -> str:
    """Run code with a working copy's grader; return what it prints."""
    return subprocess.run(
        [f'{root}/.venv/bin/python', '-P', '-c', code, str(gradebook), *arguments],
        cwd=root,
        env=os.environ | {'PATH': f'{root}/.venv/bin:{os.environ["PATH"]}'},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    ).stdout


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('verb', choices=('grade', 'feedback'))
    parser.add_argument('source', type=Path, metavar='GRADEBOOK')
    parser.add_argument('--against', type=Path, metavar='FOLDER')
    parser.add_argument('--rounds', type=int, default=3)
    args = parser.parse_args()
    there = args.against and args.against.resolve()
    sys.exit(main(args.verb, args.source.resolve(), there, args.rounds))
