"""The tiers of tests, and a guard: a test that starts something must say so.

`./course test --quick` leaves out tests that start a kernel, a node, a browser or a sandbox. Such
a test has the mark `starts`. It gets the mark here because of another mark or a fixture, or else
explicitly: by a name in STARTING_FILES, a decorator, or `@starts` below `@pytest.fixture`. Any
other test that starts something fails, in each tier.
"""

import multiprocessing.util
import os
import re
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from rclpy.context import Context

from grader.kernels import isolation

HARMLESS = re.compile(
    r'(?:\S*/)?(?:git|ruff|shellcheck|ldd|readelf|true|false|sleep|tar|unzip|alembic) .*'
    r'|(?:\S*/)?(?:sh|bash|dash|busybox|unshare)\b.*|.*/(?:course|\.ci/run)\b.*|/nowhere/.*'
    r'|bwrap --version |bwrap .* true '
    r'|\S*/python\S* (?:-P )?-m (?:grader[.\w]*parsing_process|nbgrader generate_assignment)\b.*',
    re.DOTALL,
)
"""Commands that any test may run: they start no kernel, and end by themselves."""
STARTING = re.compile(r'\bcolcon build|(?:^|[\s/])ros2 |\brclpy\b|\bipykernel')
"""Matches a shell command that starts something nevertheless."""
STARTING_FILES = frozenset(
    """
    checks_clock checks_latched checks_logs checks_sampling checks_predictions checks_relays
    checks_relays_lost checks_relays_stopped checks_servers checks_services checks_settled
    checks_delivery_experiment checks_stamps checks_tick checks_topics checks_watcher
    checks_untouched
    course course_checks course_setup crowd dask_backend doctor_faults doctor_healthy
    doctor_service_faults doctor_service_healthy doctor_actions
    executables execute grade gradebook imports
    interrupt isolation isolation_everywhere kernels kernel_messages kernel_starts
    lesson_own_program lessons_run
    live_answers live_camera live_classroom live_domain live_interrupts
    live_kernel live_kernel_ends
    live_error_hints live_lessons live_neighbours live_not_run
    live_qos_pairs live_refusals live_runner live_sliders live_target logs main
    manual_grading nbgrader_commands nbgrader_contract nodes opened_notebooks ordinary_events
    package partial preprocessors readme release replay reuse reuse_ends rooms
    rooms_hostile rooms_opening ros2_action ros2_completion
    ros2_discovery ros2_graph ros2_interfaces ros2_main ros2_notebook ros2_real ros2_run
    ros2_service ros2_shell ros2_streams same_scores survival synthetic_class temporary_folders
    validate validate_forks validate_server workers workspace_terminal
    serving serving_ends
    checks_action_servers checks_action_servers_wrong
    checks_actions checks_actions_absent checks_actions_nowhere checks_actions_not_stopped
    checks_actions_wrong live_destroying ros2_param
    live_packages package_grading
    checks_player checks_waiting_clients checks_wrong_clients command_line lean_imports
    """.split()  # noqa: SIM905
)
"""Files, test_NAME.py, in which all tests, or nearly all, start something: a kernel, or nbgrader's
command or `./course` so often that it takes too long for the quick tier."""
IMPLY = frozenset({'isolation', 'browser'})
"""Marks that imply `starts`."""


def starts(fixture: Callable) -> Callable:
    """Decorate a fixture's function that starts something: all tests that use it get the mark."""
    fixture.starts = True
    return fixture


def mark(items: list[pytest.Item]) -> None:
    """Mark the tests that start something, because of their file, a fixture or another mark."""
    for item in items:
        fixtures = getattr(item, '_fixtureinfo', None)
        used = fixtures.name2fixturedefs.values() if fixtures else ()
        by_fixture = any(getattr(each[-1].func, 'starts', False) for each in used)
        by_mark = any(item.get_closest_marker(name) for name in IMPLY)
        if starts_all(item.path) or by_fixture or by_mark:
            item.add_marker('starts')


def starts_all(path: Path) -> bool:
    """Whether all tests of this file start something."""
    return path.stem.removeprefix('test_') in STARTING_FILES


def keep_shard(items: list[pytest.Item], shard: str) -> list[pytest.Item]:
    """Keep every Nth file of tests from the Kth on; return the tests of the other shards.

    Raises pytest.UsageError if `shard` is not K/N.
    """
    part, _, parts = shard.partition('/')
    if not (part.isdecimal() and parts.isdecimal() and 1 <= int(part) <= int(parts)):
        raise pytest.UsageError(f'--shard {shard}: expected K/N, the Kth of N parts, 1/3 say')
    files = list(dict.fromkeys(item.path for item in items))
    mine = set(files[int(part) - 1 :: int(parts)])
    others = [item for item in items if item.path not in mine]
    items[:] = [item for item in items if item.path in mine]
    return others


def is_starting(item: pytest.Item) -> bool:
    """Whether a test has the mark `starts`."""
    return item.get_closest_marker('starts') is not None


class Guard:
    """Fails a test that starts something without the mark `starts`; counts ROS contexts.

    In the quick tier it also prevents the start.
    """

    def __init__(self, *, refuses: bool) -> None:
        """Guard this process; with `refuses`, raise at once, else record what is started."""
        self.refuses = refuses
        self.running: str | None = None
        self.refused: list[str] = []
        self.contexts = 0
        """How many ROS contexts were initialised so far."""
        if refuses:  # trying whether this machine has a sandbox would start one
            isolation.protections = tuple
        sys.addaudithook(self._see)
        spawn = multiprocessing.util.spawnv_passfds  # raises no audit event

        def spawn_guarded(path: str, arguments: list, descriptors: list) -> int:
            if self.refuses:  # other tiers use it themselves, in preloaded.py
                self.refuse(f'a process of multiprocessing, {os.fsdecode(path)}')
            return spawn(path, arguments, descriptors)

        multiprocessing.util.spawnv_passfds = spawn_guarded
        init = Context.init

        def init_guarded(*arguments: object, **options: object) -> None:
            self.refuse('a ROS context')
            self.contexts += 1
            init(*arguments, **options)

        Context.init = init_guarded

    def begin(self, item: pytest.Item) -> None:
        """Guard a test from its setup on, unless it may start something."""
        may_start = is_starting(item) or item.get_closest_marker('slow')
        is_lesson = item.path.suffix == '.ipynb'
        self.running = None if may_start or is_lesson else item.nodeid
        self.refused.clear()

    def end(self) -> None:
        """Stop guarding; fail the test if it started something, even if it caught the error."""
        self.running = None
        if self.refused:
            what = self.refused[0]
            self.refused.clear()
            pytest.fail(
                f'this test starts {what}, and has no mark that says so: '
                'mark it, or the fixture, with `starts` (tests/tiers.py)',
                pytrace=False,
            )

    def refuse(self, what: str) -> None:
        """Refuse to start something for the running test, or record it."""
        if not self.running:
            return
        if self.refuses:
            self.refused.append(what)
            raise RuntimeError(f'{self.running} is not marked as a test that starts {what}')
        if threading.current_thread() is threading.main_thread():  # others may be earlier tests'
            self.refused.append(what)

    def _see(self, event: str, arguments: tuple) -> None:
        if not self.running:
            return
        if event in ('subprocess.Popen', 'os.posix_spawn'):  # since 3.13, both for one process
            command = arguments[1] if isinstance(arguments[1], list | tuple) else [arguments[1]]
            line = ' '.join(map(os.fsdecode, command)) + ' '
            if not HARMLESS.fullmatch(line) or STARTING.search(line):
                self.refuse(f'the process {line:.200}')
        elif event in ('os.system', 'os.forkpty', 'os.fork'):
            self.refuse(f'a process, by {event}')
