"""`./course test`: ruff, mypy, the tests, and the lessons against their stored outputs."""

import os
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from launcher.environment import Environment
from launcher.messages import say
from launcher.unstable import (
    MOST,
    add_unstable,
    count_causes,
    read_failures,
    read_import_errors,
    read_passes,
    unstable,
)

TIERS = ('--quick', '--slow')
SHARD = '--shard='
ALL_THE_SAME = (*TIERS, '--no-isolation', SHARD)
"""Beginnings of options with which it still checks everything."""
LESSONS = 'solutions/*/*.ipynb'
PROCESSORS = len(os.sched_getaffinity(0))
MOST_WORKERS, MOST_LESSON_WORKERS = 8, 3
"""How many processes at most run tests at a time, and lessons beside them."""
LESSONS_CACHE = Path('.pytest_cache/lessons')
"""The cache of the pytest that runs the lessons: it must not share that of the tests."""
OWN_NETWORK = (
    *('bwrap', '--dev-bind', '/', '/', '--tmpfs', '/dev/shm', '--unshare-net', '--unshare-ipc'),
    '--die-with-parent',
)
"""Runs a command with a network and shared memory of its own: ROS nodes of others are not seen."""
NBVAL = (
    *('-p', 'tests.conftest', '--nbval', '--nbval-cell-timeout', '180'),
    *('-o', f'cache_dir={LESSONS_CACHE}'),
)
USAGE_ERROR = 4
"""pytest's exit status if it does not understand an argument."""
RECORD = 'unstable_tests.txt'
"""In the course's root: a line for each test that failed beside others but passed alone."""


@dataclass(frozen=True)
class Checks:
    """One run of the checks."""

    environment: Environment
    variables: dict[str, str]
    reports: Path
    """The folder of pytest's reports."""

    def call(self, *command: str) -> int:
        """Run a command in the course's folder; return its exit status."""
        root = self.environment.root
        return subprocess.call(command, cwd=root, env=self.variables)

    @contextmanager
    def parallel(self, name: str, *command: str) -> Iterator[subprocess.Popen]:
        """Run a command in the background; at the end of the block, wait and print its output."""
        said = self.reports / f'{name}.txt'
        with said.open('wb') as written:
            running = subprocess.Popen(
                command,
                cwd=self.environment.root,
                env=self.variables,
                stdout=written,
                stderr=subprocess.STDOUT,
            )
        try:
            yield running
        finally:
            running.wait()
            print(said.read_text(encoding='utf-8', errors='replace'), end='', flush=True)

    def pytest(self, report: str, *arguments: str) -> list[str]:
        """Return the command that runs pytest; `report` is the file name of its report."""
        python = str(self.environment.python)
        return [python, '-P', '-m', 'pytest', f'--junitxml={self.reports / report}', *arguments]

    def compile_tests(self) -> None:
        """Compile all tests of a fresh clone once; otherwise each worker would do it."""
        if any(self.environment.root.glob('tests/__pycache__/*-pytest-*.pyc')):
            return
        command = self.pytest('none.xml', '--collect-only', '-q', '-n', '0')
        # errors in tests are reported by the run that follows
        subprocess.run(command, cwd=self.environment.root, env=self.variables, capture_output=True)

    def tests(self, arguments: list[str]) -> list[str]:
        """Return the command that runs the tests, several at a time."""
        # most tests wait half of their time, but not those of the quick tier; all tests of a file
        # run in one worker, because they share kernels and a ROS domain
        workers = min(PROCESSORS if '--quick' in arguments else 2 * PROCESSORS + 1, MOST_WORKERS)
        many = ('-n', str(workers), '--dist', 'loadfile', '--no-loadscope-reorder')
        return self.pytest('tests.xml', *many, *arguments)

    def failed_tests(self, arguments: list[str]) -> list[str]:
        """Return the command that runs the failed tests again, one at a time."""
        alone = ('--last-failed', '-n', '0', '--maxfail', '5')
        return self.pytest('tests-alone.xml', '-v', *arguments, *alone)

    def lessons(self, shard: list[str]) -> list[str]:
        """Return the command that runs the lessons, and compares their stored outputs."""
        many = ('-n', str(min(PROCESSORS, MOST_LESSON_WORKERS)), '--dist', 'loadfile', 'solutions')
        return self.pytest('lessons.xml', *NBVAL, *shard, *many)

    def failed_lessons(self, shard: list[str]) -> list[str]:
        """Return the command that runs failed lessons again, each completely, one at a time."""
        failed = failed_lessons(self.environment.root) or ['solutions']
        return self.pytest('lessons-alone.xml', *NBVAL, *shard, '-v', '-n', '0', *failed)

    def rerun(self, what: str, status: int, command: Callable[[], list[str]]) -> int:
        """Run failed tests again, one at a time; those that fail twice have failed.

        On a busy machine, tests can fail without a fault. Those that pass alone are recorded, with
        their reasons; if a run has more than MOST causes of this kind, the run has failed, too. A
        file that can't be imported is not run again.
        """
        if status != 1:
            return status
        if errors := read_import_errors(self.reports / f'{what}.xml'):
            for path, why in errors.items():
                say(f'{path} could not be imported, so none of its tests were run: {why}')
            say('fix that, and run this again')
            return status
        say(f'the {what} named above failed while others ran: now they run again, one at a time')
        status = self.call(*command())
        passed = unstable(
            read_failures(self.reports / f'{what}.xml'),
            read_passes(self.reports / f'{what}-alone.xml'),
        )
        if passed:
            record = self.environment.root / RECORD
            written = add_unstable(record, passed)
            say(
                f'{len(passed)} of the {what} failed while others ran and passed alone; the '
                f'reasons are in {RECORD}, which now has {written} entries'
            )
        if count_causes(passed) > MOST:
            say(f'more than {MOST} of them in a run count as a failure: find out why they failed')
            return status or 1
        return status


def run(environment: Environment, variables: dict[str, str], arguments: list[str]) -> int:
    """Run all checks even after a failure; return the exit status of the last failure."""
    if not {'-h', '--help'}.isdisjoint(arguments):
        asked = Checks(environment, variables, Path())
        return asked.call(str(environment.python), '-P', '-m', 'pytest', '--help')
    options = [argument for argument in arguments if argument.startswith(ALL_THE_SAME)]
    named = [argument for argument in arguments if not argument.startswith(ALL_THE_SAME)]
    with tempfile.TemporaryDirectory(prefix='reports-') as reports:
        checks = Checks(environment, variables, Path(reports))
        ruff = str(environment.venv / 'bin/ruff')
        statuses = [checks.call(ruff, 'check', '.'), checks.call(ruff, 'format', '--check', '.')]
        tests, shard = [*options, *named], [each for each in options if each.startswith(SHARD)]
        # not if single tests or the quick tier were asked for
        is_all = not named and '--quick' not in options
        has_lessons = is_all and any(environment.root.glob(LESSONS))
        with ExitStack() as jobs:
            types = jobs.enter_context(checks.parallel('mypy', str(environment.venv / 'bin/mypy')))
            in_lessons = None
            if is_all:
                checks.compile_tests()
            if has_lessons and has_own_network():
                command = [*OWN_NETWORK, *checks.lessons(shard)]
                in_lessons = jobs.enter_context(checks.parallel('lessons', *command))
            status = checks.call(*checks.tests(tests))
            if status == USAGE_ERROR:  # pytest has printed it, and nothing was tested
                for other in filter(None, (types, in_lessons)):
                    other.terminate()
                return status
        statuses.append(types.returncode)
        statuses.append(checks.rerun('tests', status, lambda: checks.failed_tests(tests)))
        if has_lessons:
            status = in_lessons.returncode if in_lessons else checks.call(*checks.lessons(shard))
            statuses.append(checks.rerun('lessons', status, lambda: checks.failed_lessons(shard)))
    return next((status for status in reversed(statuses) if status), 0)


def has_own_network() -> bool:
    """Return whether OWN_NETWORK works on this machine."""
    try:
        return subprocess.run([*OWN_NETWORK, 'true'], capture_output=True).returncode == 0
    except OSError:
        return False


def failed_lessons(root: Path) -> list[str]:
    """Return the paths of the lessons that failed in the last run, by pytest's cache."""
    remembered = root / LESSONS_CACHE / 'v/cache/lastfailed'
    text = remembered.read_text(encoding='utf-8') if remembered.is_file() else ''
    lessons = (str(path.relative_to(root)) for path in sorted(root.glob(LESSONS)))
    return [lesson for lesson in lessons if f'"{lesson}::' in text]
