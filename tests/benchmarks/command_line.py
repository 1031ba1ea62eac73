"""How long `./course` takes to answer: help, wrong arguments, a run with nothing new, a first run.

    .venv/bin/python tests/benchmarks/command_line.py [RUNS] [--against FOLDER] [--sample NAME]

FOLDER is the working copy of an earlier commit with its own .venv (`./course doctor` makes it):
commands alternate between both, so that they run under the same conditions. Each has a temporary
gradebook with one submission, the sample NAME. `grade` is started as the launcher starts it, but
without the launcher; the rows with wrong arguments include the launcher. CPU is that of all
processes that were waited for; kernels are forked by servers, so theirs is not included. Nothing
is asserted: look at the ratios.
"""

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from launcher.environment import ros_libraries

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / 'tests/submissions'
SAMPLE = '03_publisher-fail-untouched'
FIXED = {
    'Python alone': ['.venv/bin/python', '-IS', '-c', ''],
    './course --help': ['./course', '--help'],
    './course nonsense': ['./course', 'nonsense'],
    './course grade --nonsense': ['./course', 'grade', '--nonsense'],
    './course collect': ['./course', 'collect'],
}
"""Commands that do not use a gradebook."""
NOTHING_NEW, FIRST = 'grade, nothing new', 'grade, one, cold'
ELSEWHERE = """
import dataclasses, sys
from pathlib import Path
sys.argv, gradebook = ['grade', 'grade'], Path(sys.argv[1])
from grader import __main__
from grader.cli import verbs
def grade(course, asked):
    return run(dataclasses.replace(course, gradebook=gradebook), asked)
run, verbs.run_grade = verbs.run_grade, grade
getattr(__main__, 'run', lambda: sys.exit(__main__.main()))()  # an earlier commit has no `run`
"""
"""What the launcher runs for `./course grade`, but with another gradebook."""


@dataclass
class Taken:
    """The times of one command's runs."""

    wall_sec: list[float] = field(default_factory=list)
    cpu_sec: list[float] = field(default_factory=list)

    def median(self) -> tuple[float, float]:
        """Return the medians of wall time and CPU time, in milliseconds."""
        return 1000 * statistics.median(self.wall_sec), 1000 * statistics.median(self.cpu_sec)


@dataclass(frozen=True)
class Checkout:
    """A working copy of the course, with a temporary gradebook."""

    root: Path
    gradebook: Path
    taken: dict[str, Taken] = field(default_factory=dict)

    def grade(self) -> list[str]:
        """Return the command of `./course grade` without the launcher."""
        return ['.venv/bin/python', '-P', '-c', ELSEWHERE, str(self.gradebook)]

    def run(self, name: str, command: list[str]) -> None:
        """Run a command, and record its times."""
        taken = self.taken.setdefault(name, Taken())
        environment = {k: v for k, v in os.environ.items() if not k.startswith(('COV', '_ROS'))}
        environment |= {'PATH': f'{self.root}/.venv/bin:{os.environ["PATH"]}'}
        if command[0] != './course':  # the launcher would set these
            environment |= ros_libraries(f'{self.root}/.venv', environment)
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, cwd=self.root, env=environment, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.wall_sec.append(time.perf_counter() - began)
        taken.cpu_sec.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)

    def forget(self) -> None:
        """Remove the result, so that the submission counts as new in the same gradebook."""
        shutil.rmtree(self.gradebook / 'autograded', ignore_errors=True)


def main(runs: int, against: Path | None, sample: str) -> None:
    """Print a row for each command."""
    with tempfile.TemporaryDirectory(prefix='command_line-') as folder:
        roots = [ROOT, *([against] if against else [])]
        checkouts = [Checkout(root, Path(folder, str(n))) for n, root in enumerate(roots)]
        for checkout in checkouts:
            hand_in(checkout, sample)
            checkout.run('warm-up', checkout.grade())
        for _ in range(runs):
            for checkout in checkouts:
                for name, command in FIXED.items():
                    checkout.run(name, command)
                checkout.run(NOTHING_NEW, checkout.grade())
                checkout.forget()
                checkout.run(FIRST, checkout.grade())
    print_table(checkouts, runs)


def hand_in(checkout: Checkout, sample: str) -> None:
    """Put the sample into the gradebook's submitted/."""
    assignment = sample.split('-')[0]
    folder = checkout.gradebook / 'submitted/ada' / assignment
    folder.mkdir(parents=True)
    shutil.copyfile(SAMPLES / f'{sample}.ipynb', folder / f'{assignment}.ipynb')


def print_table(checkouts: list[Checkout], runs: int) -> None:
    """Print the medians in milliseconds, and their ratios to those of the other working copy."""
    ours, *others = checkouts
    print(f'{f"median of {runs}, in ms":28} {"wall":>7} {"CPU":>7}', end='')
    print(f' {"wall":>9} {"CPU":>7} {"ratio":>9} {"of CPU":>7}' if others else '')
    for name in (*FIXED, NOTHING_NEW, FIRST):
        wall, cpu = ours.taken[name].median()
        print(f'{name:28} {wall:7.0f} {cpu:7.0f}', end='')
        for other in others:
            their_wall, their_cpu = other.taken[name].median()
            print(f' {their_wall:9.0f} {their_cpu:7.0f}', end='')
            print(f' {wall / their_wall:9.2f} {cpu / their_cpu:7.2f}', end='')
        print(flush=True)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('runs', type=int, nargs='?', default=5)
    parser.add_argument('--against', type=Path, metavar='FOLDER')
    parser.add_argument('--sample', default=SAMPLE, metavar='NAME')
    args = parser.parse_args()
    main(args.runs, args.against and args.against.resolve(), args.sample)
