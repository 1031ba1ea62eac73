"""What every test session needs: a ROS domain of its own, and kernels that know of no pytest."""

import asyncio
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import _pytest.runner
import nbgrader.api
import pytest
from hypothesis import HealthCheck, settings
from my_robot_basics.session import classroom

from grader.authoring import release
from grader.kernels.isolation import TRUST, missing
from tests import ordinary, preloaded, tiers  # also where nbval runs with this as a plugin

if TYPE_CHECKING:
    from grading_kernels import Spares
    from postgresql_server import Server

    from grader.course import Course
    from grader.kernels.kernels import GradingKernel
    from grader.sandbox.sandbox import Sandbox

# a busy machine fails no test
settings.register_profile('busy', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('busy')


# each new database asks a program, which takes 2 s, for what is always the same
nbgrader.api.get_alembic_version = cache(nbgrader.api.get_alembic_version)

UNTESTED = pytest.StashKey[list]()
"""The tests that a machine without a sandbox leaves out."""

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
"""Files that take longest come first: begun at the end, one would be waited for alone. Those that
keep processors busy stand beside those that wait: all at once, each would take longer."""


LONG_LESSONS = ('12_package', '09_actions', '11_parameters', '07_common_errors', '08_services')


GUARD = pytest.StashKey[tiers.Guard]()
FOLDERS = pytest.StashKey[list[Path]]()
"""What a session has made for itself: the workspace, what Validate remembers, what is shared."""


def pytest_addoption(parser: pytest.Parser) -> None:
    tier = parser.getgroup('tiers')
    tier.addoption(
        '--quick', action='store_true', help='no kernel, node, browser or sandbox: about a minute'
    )
    tier.addoption('--shard', metavar='K/N', help='of all files every Nth, from the Kth on')
    tier.addoption('--slow', action='store_true', help='everything, also what takes long')
    parser.addoption(
        '--no-isolation',
        action='store_true',
        help='where this machine has no sandbox: do without it, and without the tests of it',
    )


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    # even to import what is not run takes seconds
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

    if config.getoption('--no-isolation') and missing():
        config.stash[UNTESTED] = [item for item in items if item.get_closest_marker('isolation')]
        items[:] = [item for item in items if item not in config.stash[UNTESTED]]
        config.hook.pytest_deselected(items=config.stash[UNTESTED])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    yield
    item.config.stash[GUARD].end()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    item.config.stash[GUARD].running = None  # what a test leaves may take what it takes to end
    yield
    item.config.stash[GUARD].end()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.config.stash[GUARD].begin(item)
    if item.path.suffix == '.ipynb':
        # its kernel is started next: what another lesson has written is not there
        workspace = item.config.stash[FOLDERS][0] / item.path.stem
        os.environ['MY_ROBOT_BASICS_WORKSPACE'] = str(workspace)
    if item.get_closest_marker('isolation') and missing():
        pytest.fail(f'{missing()}. Or leave these tests out: --no-isolation', pytrace=False)


def pytest_terminal_summary(terminalreporter: object, config: pytest.Config) -> None:
    if config.getoption('--no-isolation') and missing():
        # xdist's workers know how many, and have no summary
        untested = len(config.stash.get(UNTESTED, [])) or 'all'
        terminalreporter.section('not tested', yellow=True)
        terminalreporter.line(f'{untested} tests of the sandbox: {missing()}')


def pytest_configure(config: pytest.Config) -> None:
    quick = config.getoption('--quick')
    if config.getoption('--slow'):
        config.option.markexpr = ''
    elif quick:
        config.option.markexpr = 'not slow and not starts'
    config.stash[GUARD] = tiers.Guard(refuses=quick)
    if not quick:  # that tier starts no server
        release.subprocess = preloaded
    if config.getoption('--no-isolation'):
        os.environ[TRUST] = '1'
    # a session in the background ignores Ctrl-C, and so would all that it starts
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # and one below nohup the end of its terminal
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    # what a student's terminal has not: programs here would print sooner than theirs
    os.environ.pop('PYTHONUNBUFFERED', None)
    # colcon's builds warn where somebody has set it
    os.environ.pop('PYTHONDONTWRITEBYTECODE', None)
    sys.dont_write_bytecode = False  # else each xdist worker would compile every test, every time
    # once in each xdist worker, too: two workers do not discover each other's nodes
    folders = config.stash[FOLDERS] = [Path(tempfile.mkdtemp(prefix='ros ws '))]
    os.environ['MY_ROBOT_BASICS_WORKSPACE'] = str(folders[0])
    # Validate writes there what has passed
    folders.append(Path(tempfile.mkdtemp(prefix='data ')))
    os.environ['XDG_DATA_HOME'] = str(folders[1])
    if not hasattr(config, 'workerinput'):  # what is made once, also for xdist's workers
        folders.append(Path(tempfile.mkdtemp(prefix='shared-')))
        os.environ['MY_ROBOT_BASICS_TESTS'] = str(folders[2])
    if config.getoption('--nbval'):
        from tests import lesson_kernels  # all that nbval imports, which other sessions need not

        folders.append(Path(tempfile.mkdtemp(prefix='zmq-')))
        lesson_kernels.prepare(folders[-1])
    classroom.enter()


def pytest_unconfigure(config: pytest.Config) -> None:
    for folder in config.stash[FOLDERS]:
        shutil.rmtree(folder)


LEAVE_SEC = 10.0
"""How long the nodes of a file's last test may take to end."""


@pytest.fixture(scope='module', autouse=True)
def nobody_stays(request: pytest.FixtureRequest) -> Iterator[None]:
    """See that a file of tests leaves no node to the next one in the same domain."""
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


def _answers() -> dict[signal.Signals, object]:
    stopping = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
    return {number: signal.getsignal(number) for number in stopping}


@pytest.fixture(scope='module', autouse=True)
def as_the_file_before() -> Iterator[None]:
    """See that a file of tests answers no signal for the files behind it."""
    former = _answers()
    yield
    left = _answers()
    for number, answer in former.items():
        signal.signal(number, answer)
    assert left == former, 'the tests of this file left other answers to signals'


@pytest.fixture
def signals() -> Iterator[None]:
    """Put back what nbclient answers Ctrl-C with, and leaves where a kernel does not start."""
    former = _answers()
    yield
    for number, answer in former.items():
        signal.signal(number, answer)


# ipykernel leaves the logs of C code alone where it finds PYTEST_CURRENT_TEST, and every kernel
# that a test starts would inherit it: notebooks would behave otherwise than for a student. A hook
# cannot delete it: pytest sets it in the same step that runs the test.
_pytest.runner._update_current_test_var = lambda item, when: None


@pytest.fixture(scope='module')
def loop() -> Iterator[asyncio.Runner]:
    """What runs the coroutines of a file's tests, all in one event loop."""
    with asyncio.Runner() as runner:
        yield runner


@pytest.fixture
@tiers.starts
def sandbox(loop: asyncio.Runner) -> Iterator['Sandbox']:
    """A sandbox of one test's own."""
    from inside_sandbox import opened  # not before: most need no sandbox

    with opened(loop) as sandbox:
        yield sandbox


@pytest.fixture(scope='module')
@tiers.starts
def shared_sandbox(loop: asyncio.Runner) -> Iterator['Sandbox']:
    """A sandbox for all tests of a file that do it no harm."""
    from inside_sandbox import opened

    with opened(loop) as sandbox:
        yield sandbox


@pytest.fixture
@tiers.starts
def own_kernel(loop: asyncio.Runner) -> Iterator['GradingKernel']:
    """A kernel of one test's own."""
    from grading_kernels import opened_kernel  # not before: most need no kernel

    with opened_kernel(loop) as kernel:
        yield kernel


@pytest.fixture(scope='module')
@tiers.starts
def spares(loop: asyncio.Runner) -> Iterator['Spares']:
    """The kernels that tests of a file have left alive."""
    from grading_kernels import Spares

    spares = Spares(loop)
    yield spares
    spares.stop()


@pytest.fixture
def spare_kernel(spares: 'Spares') -> Iterator['GradingKernel']:
    """A kernel for a cell that leaves nothing in it."""
    with spares.kernel() as kernel:
        yield kernel


@pytest.fixture
def run_cell(loop: asyncio.Runner) -> Callable:
    """What runs a cell in a kernel: `run_cell(kernel, code)`."""
    from grading_kernels import runs_in

    return runs_in(loop)


@pytest.fixture(scope='module')
def released(tmp_path_factory: pytest.TempPathFactory) -> 'Course':
    """The course of one small lesson, released: for all tests of a file that do it no harm."""
    from course_maker import released_course  # not before: most need no course

    return released_course(tmp_path_factory.mktemp('released'))


@pytest.fixture
def course(released: 'Course', tmp_path: Path) -> 'Course':
    """That course, with an empty gradebook of one test's own; other files have it filled."""
    return replace(released, gradebook=tmp_path / 'gradebook')


@pytest.fixture
def came_in(tmp_path: Path) -> Path:
    """The folder that `./course collect` or `./course serve` takes submissions from."""
    folder = tmp_path / 'came in'
    folder.mkdir()
    return folder


@pytest.fixture(scope='module')
def postgresql() -> 'Iterator[Server]':
    """A server of Debian's package, for the tests of one module."""
    from postgresql_server import running  # not before: most need no database

    with running() as server:
        yield server


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever lies in the folder of `./course serve` is whole."""
    from grader.serving import inbound  # not before: most serve nothing

    monkeypatch.setattr(inbound, 'QUIET_SEC', -1.0)


@pytest.fixture
@tiers.starts
def run() -> Iterator[Callable]:
    """`live.run`; all nodes that it started are stopped after the test, and their threads."""
    from nodes.running import stop_all

    from my_robot_basics import live  # not before: most need no rclpy

    yield live.run
    stop_all()


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the robot's clock no limit of wall time: what is exact must be so on any machine."""
    from my_robot_basics.checks import (  # not before: most need no rclpy
        barriers,
        clock,
        clock_budget,
    )

    for module, limit in (
        (clock_budget, 'BUDGET_SEC'),
        (barriers, 'SLOWEST_BARRIER_SEC'),
        (barriers, 'SLOWEST_MEDIAN_SEC'),
        (clock, 'SLOWEST_BARRIER_SEC'),
    ):
        monkeypatch.setattr(module, limit, 100.0)
    # some nodes of the tests never answer
    monkeypatch.setattr(clock, 'FIRST_ANSWER_SEC', 5.0)
