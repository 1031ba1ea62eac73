"""What every test session needs: a ROS domain of its own, kernels that do not notice pytest."""

import asyncio
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import _pytest.runner
import nbgrader.api
import pytest
from hypothesis import HealthCheck, settings
from my_robot_basics.session import classroom

from grader.authoring import release
from grader.kernels.isolation import TRUST, missing_protection
from tests import ordinary, preloaded, tiers  # absolute, as nbval runs with this as a plugin, too

if TYPE_CHECKING:
    from grading_kernels import Spares
    from postgresql_server import Server

    from grader.course import Course
    from grader.kernels.kernels import GradingKernel
    from grader.sandbox.sandbox import Sandbox

# what several test modules share: an assertion there shows its values, too, when it fails
SHARED = [path.stem for path in Path(__file__).parent.glob('*.py') if path.stem[:5] != 'test_']
pytest.register_assert_rewrite(*SHARED)

# a test must not fail because the machine is busy
settings.register_profile('busy', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('busy')


# for each new database, nbgrader runs a program for 2 s, always with the same result
nbgrader.api.get_alembic_version = cache(nbgrader.api.get_alembic_version)

UNTESTED = pytest.StashKey[list]()
"""The tests that are left out on a machine without a sandbox."""

LONG = (
    *('checks_relays_lost', 'sample_class', 'browser', 'checks_sampling', 'nbgrader_commands'),
    *('live_kernel', 'attacks', 'checks_topics', 'release', 'kernel_exits', 'workers', 'answers'),
    *('doctor_faults', 'interrupt', 'course_setup', 'ros2_streams', 'checks_clock', 'kernels'),
    *('workspace', 'checks_logs', 'hidden', 'executables', 'live_lessons', 'checks_stamps'),
    *('survival', 'dask_backend', 'sandbox', 'browser_hostile', 'fork_servers', 'environment'),
    *('lesson_own_program', 'package', 'formgrader', 'validate', 'ros2_graph', 'lessons_run'),
    *('full_disk', 'accessibility', 'live_target', 'hidden_inputs', 'isolation', 'execute'),
    *('ros2_service', 'rooms', 'bundle', 'feedback', 'collect', 'report', 'live_arm'),
    *('live_interrupts', 'course', 'checks_relays', 'sandbox_share', 'kernel_messages'),
)
"""The files that take longest run first: if one began last, all workers would wait for it. Files
that keep processors busy alternate with those that wait: together, each would take longer."""


LONG_LESSONS = ('12_package', '09_actions', '11_parameters', '07_common_errors', '08_services')


GUARD = pytest.StashKey[tiers.Guard]()
FOLDERS = pytest.StashKey[list[Path]]()
"""Folders made for the session: for the workspace, for Validate's records, for shared files."""


def pytest_addoption(parser: pytest.Parser) -> None:
    tier = parser.getgroup('tiers')
    tier.addoption(
        '--quick', action='store_true', help='no kernel, node, browser or sandbox: about a minute'
    )
    tier.addoption('--shard', metavar='K/N', help='of all files every Nth, from the Kth on')
    tier.addoption('--slow', action='store_true', help='everything, also what takes long')
    parser.addoption('--answer', metavar='NAME', help='of tests/answers/: only those of that name')
    parser.addoption(
        '--no-isolation',
        action='store_true',
        help='where this machine has no sandbox: do without it, and without the tests of it',
    )


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    # even importing files that are not run takes seconds
    return (config.getoption('--quick') and tiers.starts_all(collection_path)) or None


@pytest.hookimpl(tryfirst=True)  # pytest chooses by the marks afterwards
def pytest_collection_modifyitems(config: pytest.Config, items: list) -> None:
    order = {f'test_{name}': place for place, name in enumerate(LONG)}
    order |= {name: place for place, name in enumerate(LONG_LESSONS)}
    items.sort(key=lambda item: order.get(item.path.stem, len(LONG)))
    tiers.mark(items)
    ordinary.mark_slow(items)
    if shard := config.getoption('--shard'):
        config.hook.pytest_deselected(items=tiers.keep_shard(items, shard))

    if config.getoption('--no-isolation') and missing_protection():
        config.stash[UNTESTED] = [item for item in items if item.get_closest_marker('isolation')]
        items[:] = [item for item in items if item not in config.stash[UNTESTED]]
        config.hook.pytest_deselected(items=config.stash[UNTESTED])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    yield
    item.config.stash[GUARD].end()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    item.config.stash[GUARD].running = None  # the end of a test's processes may take any time
    yield
    item.config.stash[GUARD].end()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.config.stash[GUARD].begin(item)
    if item.path.suffix == '.ipynb':
        # its kernel starts next: it must not see what another lesson has built
        workspace = item.config.stash[FOLDERS][0] / item.path.stem
        os.environ['MY_ROBOT_BASICS_WORKSPACE'] = str(workspace)
    if item.get_closest_marker('isolation') and missing_protection():
        pytest.fail(
            f'{missing_protection()}. Or leave these tests out: --no-isolation', pytrace=False
        )


def pytest_terminal_summary(terminalreporter: object, config: pytest.Config) -> None:
    if config.getoption('--no-isolation') and missing_protection():
        # xdist's workers know the number, but only the main process prints a summary
        untested = len(config.stash.get(UNTESTED, [])) or 'all'
        terminalreporter.section('not tested', yellow=True)
        terminalreporter.line(f'{untested} tests of the sandbox: {missing_protection()}')


def pytest_configure(config: pytest.Config) -> None:
    quick = config.getoption('--quick')
    if config.getoption('--slow'):
        config.option.markexpr = ''
    elif quick:
        config.option.markexpr = 'not slow and not starts'
    config.stash[GUARD] = tiers.Guard(refuses=quick)
    if not quick:  # the quick tier starts no fork server
        release.subprocess = preloaded
    if config.getoption('--no-isolation'):
        os.environ[TRUST] = '1'
    # a session in the background ignores Ctrl-C, and its child processes would inherit that
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # a session under nohup ignores SIGHUP
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    # a student's terminal does not set it: programs would print sooner here
    os.environ.pop('PYTHONUNBUFFERED', None)
    # colcon's builds warn if it is set
    os.environ.pop('PYTHONDONTWRITEBYTECODE', None)
    sys.dont_write_bytecode = False  # or each xdist worker would compile all tests each time
    # in each xdist worker, too, so that two workers do not discover each other's nodes
    folders = config.stash[FOLDERS] = [Path(tempfile.mkdtemp(prefix='ros ws '))]
    os.environ['MY_ROBOT_BASICS_WORKSPACE'] = str(folders[0])
    # Validate records there which exercises have passed
    folders.append(Path(tempfile.mkdtemp(prefix='data ')))
    os.environ['XDG_DATA_HOME'] = str(folders[1])
    if not hasattr(config, 'workerinput'):  # the main process, which shares this with its workers
        folders.append(Path(tempfile.mkdtemp(prefix='shared-')))
        os.environ['MY_ROBOT_BASICS_TESTS'] = str(folders[2])
    if config.getoption('--nbval'):
        from tests import lesson_kernels  # imports nbval, which other sessions do not need

        folders.append(Path(tempfile.mkdtemp(prefix='zmq-')))
        lesson_kernels.prepare(folders[-1])
    classroom.enter()


def pytest_unconfigure(config: pytest.Config) -> None:
    for folder in config.stash[FOLDERS]:
        shutil.rmtree(folder)


LEAVE_SEC = 30.0
"""How long the nodes of a file's last test may take to end: if a busy machine drops the farewell
of a node, DDS waits for its lease to expire."""


@pytest.fixture(scope='module', autouse=True)
def nobody_stays(request: pytest.FixtureRequest) -> Iterator[None]:
    """Check that a file of tests leaves no nodes to the next file in the same ROS domain."""
    guard = request.config.stash[GUARD]
    before = guard.contexts
    yield
    here = (item for item in request.session.items if item.path == request.path)
    if guard.contexts == before and not any(map(tiers.is_starting, here)):
        return
    from my_robot_basics.checks import graph

    deadline = time.monotonic() + LEAVE_SEC
    while (left := graph().nodes()) and time.monotonic() < deadline:
        pass
    assert not left, f'the tests of this file left nodes behind: {", ".join(left)}'


@dataclass(frozen=True)
class Answers:
    """How this process answers signals."""

    handlers: dict[signal.Signals, object]
    wakeup_fd: int
    """Where Python writes the number of each signal, for an event loop; -1: nowhere."""

    @classmethod
    def now(cls) -> 'Answers':
        stopping = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
        wakeup_fd = signal.set_wakeup_fd(-1)
        signal.set_wakeup_fd(wakeup_fd, warn_on_full_buffer=False)
        return cls({number: signal.getsignal(number) for number in stopping}, wakeup_fd)

    def restore(self) -> None:
        for number, handler in self.handlers.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self.wakeup_fd, warn_on_full_buffer=False)


@pytest.fixture(scope='module', autouse=True)
def as_the_file_before() -> Iterator[None]:
    """Check that a file of tests does not change the answers to signals for the files after it."""
    former = Answers.now()
    yield
    left = Answers.now()
    former.restore()
    assert left == former, 'the tests of this file left other answers to signals'


@pytest.fixture
def signals() -> Iterator[None]:
    """Restore the answers to signals that nbclient sets, and leaves if a kernel does not start.

    Its event loop is used again: at the next notebook it would handle each signal sent meanwhile,
    and end that notebook's kernel.
    """
    former = Answers.now()
    yield
    former.restore()


# ipykernel does not capture the output of C code if PYTEST_CURRENT_TEST is set, and every kernel
# that a test starts would inherit it: notebooks would behave differently than for a student. A
# hook can't delete it, because pytest sets it in the same step in which it runs the test.
_pytest.runner._update_current_test_var = lambda item, when: None


@pytest.fixture(scope='module')
def loop() -> Iterator[asyncio.Runner]:
    """A runner for the coroutines of a file's tests, all in one event loop."""
    with asyncio.Runner() as runner:
        yield runner


@pytest.fixture
@tiers.starts
def sandbox(loop: asyncio.Runner) -> Iterator['Sandbox']:
    """A sandbox for one test."""
    from inside_sandbox import opened  # imported late: most tests need no sandbox

    with opened(loop) as sandbox:
        yield sandbox


@pytest.fixture(scope='module')
@tiers.starts
def shared_sandbox(loop: asyncio.Runner) -> Iterator['Sandbox']:
    """A sandbox that all tests of a file share; they must not damage it."""
    from inside_sandbox import opened

    with opened(loop) as sandbox:
        yield sandbox


@pytest.fixture
@tiers.starts
def own_kernel(loop: asyncio.Runner) -> Iterator['GradingKernel']:
    """A kernel for one test."""
    from grading_kernels import opened_kernel  # imported late: most tests need no kernel

    with opened_kernel(loop) as kernel:
        yield kernel


@pytest.fixture(scope='module')
@tiers.starts
def spares(loop: asyncio.Runner) -> Iterator['Spares']:
    """Kernels that survived earlier tests of the file."""
    from grading_kernels import Spares

    spares = Spares(loop)
    yield spares
    spares.stop()


@pytest.fixture
def spare_kernel(spares: 'Spares') -> Iterator['GradingKernel']:
    """A kernel for a cell that leaves nothing behind in it."""
    with spares.kernel() as kernel:
        yield kernel


@pytest.fixture
def run_cell(loop: asyncio.Runner) -> Callable:
    """A function that runs a cell in a kernel: `run_cell(kernel, code)`."""
    from grading_kernels import runs_in

    return runs_in(loop)


@pytest.fixture(scope='module')
def released(tmp_path_factory: pytest.TempPathFactory) -> 'Course':
    """The released course of one small lesson, shared by all tests of a file; do not change it."""
    from course_maker import released_course  # imported late: most tests need no course

    return released_course(tmp_path_factory.mktemp('released'))


@pytest.fixture
def course(released: 'Course', tmp_path: Path) -> 'Course':
    """The released course with a new, empty gradebook; some files override this fixture."""
    return replace(released, gradebook=tmp_path / 'gradebook')


@pytest.fixture
def came_in(tmp_path: Path) -> Path:
    """The folder from which `./course collect` or `./course serve` takes submissions."""
    folder = tmp_path / 'came in'
    folder.mkdir()
    return folder


@pytest.fixture(scope='module')
def postgresql() -> 'Iterator[Server]':
    """A PostgreSQL server of Debian's package, for the tests of one module."""
    from postgresql_server import running  # imported late: most tests need no database

    with running() as server:
        yield server


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `./course serve` take files at once, without waiting until they are unchanged."""
    from grader.serving import inbound  # imported late: most tests serve nothing

    monkeypatch.setattr(inbound, 'QUIET_SEC', -1.0)


@pytest.fixture
@tiers.starts
def run() -> Iterator[Callable]:
    """`live.run`; all nodes that it started, and their threads, are stopped after the test."""
    from nodes.running import stop_all

    from my_robot_basics import live  # imported late: most tests need no rclpy

    yield live.run
    stop_all()


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Remove wall time limits of the simulated clock: exact results must not depend on load."""
    from my_robot_basics.checks.clock import barriers, clock, clock_budget

    for module, limit in (
        (clock_budget, 'BUDGET_SEC'),
        (barriers, 'SLOWEST_BARRIER_SEC'),
        (barriers, 'SLOWEST_MEDIAN_SEC'),
        (clock, 'SLOWEST_BARRIER_SEC'),
    ):
        monkeypatch.setattr(module, limit, 100.0)
    # some nodes of the tests never answer
    monkeypatch.setattr(clock, 'FIRST_ANSWER_SEC', 5.0)
