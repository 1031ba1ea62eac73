"""A forked kernel is like a started one, and shares nothing with other kernels."""

import ast
import functools
import os
import time
from pathlib import Path

import psutil
import pytest
from forked_kernels import (
    FIRST_SLOT,
    closed,
    kernel_of,
    opened,
    printed,
    process_of,
    server_of,
)

from grader.common.errors import RoomFailure
from grader.course import ROOT
from grader.kernels import fork_client
from grader.sandbox.bubblewrap import slot_user

pytestmark = pytest.mark.isolation

SEED = 'canary-seed-' + '5eed' * 8


@pytest.fixture(scope='module')
def forked(loop):
    yield from kernel_of(loop)


@pytest.fixture(scope='module')
def started(loop):
    yield from kernel_of(loop, fresh=True)


@pytest.fixture
def own(loop):
    """A forked kernel of one test's own."""
    yield from kernel_of(loop)


@pytest.fixture
def said(loop):
    """Return a function that runs a cell and returns what it prints."""
    return functools.partial(printed, loop)


# -- the same kernel ------------------------------------------------------------------------------

LOOKS = {
    'rights': """
kinds = ('Cap', 'NoNewPrivs', 'Seccomp', 'Uid', 'Gid', 'Groups', 'Umask', 'Sig', 'Pid', 'NSpid')
print([line for line in open('/proc/self/status') if line.startswith(kinds)
       and not line.startswith(('SigQ', 'SigPnd'))])
import os; print(os.getresuid(), os.getresgid(), os.getgroups())
""",
    'what Linux is told about it': """
import ctypes, os
prctl = ctypes.CDLL(None).prctl
# dumpable, keeps capabilities, secure bits, no new privileges, tracer, subreaper, slack, THP
print([prctl(option, 0, 0, 0, 0) for option in (3, 7, 27, 39, 30, 42)])
print(os.getpriority(0, 0), os.sched_getscheduler(0), os.sched_getaffinity(0), os.umask(0o22))
""",
    'limits': """
import resource
names = [name for name in dir(resource) if name.startswith('RLIMIT_')]
print([(name, resource.getrlimit(getattr(resource, name))) for name in names])
print(open('/proc/self/oom_score_adj').read())
""",
    'environment': 'import os; print(sorted(os.environ.items()), os.getcwd())',
    'what it can open': """
import os, re
links = {os.readlink(f'/proc/self/fd/{f}') for f in os.listdir('/proc/self/fd')[3:-1]}
print(sorted({re.sub(r'\\d+', '', link) for link in links}))
""",
    'mounts': """
import re
for line in sorted(open('/proc/self/mountinfo'), key=lambda line: line.split()[4]):
    own, _, general = line.partition(' - ')
    own, general = own.split(), general.split()
    # but for numbers, and for who the slot's user is
    print(own[4], own[5], general[0], re.sub('id=[0-9]+', '', general[2]))
""",
    'terminal': """
import os
print(open('/proc/self/stat').read().split()[6], os.getsid(0) == os.getpid(),
      os.getpgid(0) == os.getpid())
try: open('/dev/tty')
except OSError as error: print(error)
""",
    'processes': "import os; print(sorted(p for p in os.listdir('/proc') if p.isdigit()))",
    'Python': """
import locale, signal, sys, sysconfig, time
print(sys.argv, sys.orig_argv, sys.path, sys.flags, sys.flags.safe_path, sys.executable)
print(sys.prefix, sys.exec_prefix, sys.base_prefix, sys.warnoptions, sys._xoptions)
print(sys.getrecursionlimit(), sys.getswitchinterval(), sys.dont_write_bytecode, sys.platform)
print([str(f).split(' at ')[0] for f in sys.meta_path])
print([hook for hook in sys.path_hooks if isinstance(hook, type)])
print(sys.stdin, sys.__stdout__.encoding, sys.__stderr__.encoding, sys.getfilesystemencoding())
print([(n, str(signal.getsignal(n)).split(' at ')[0]) for n in signal.valid_signals()])
print(locale.setlocale(locale.LC_ALL), time.tzname, __name__)
""",
    'names': 'print(sorted(dir())); print(sorted(vars(__builtins__)))',
    'frames': """
import sys
frame, names = sys._getframe(), []
# what launches an instance is another file, as it has to be
while frame and names[-1:] != ['launch_instance']:
    names.append(frame.f_code.co_name)
    frame = frame.f_back
print(names)
""",
    'threads': """
import threading
print([(type(thread).__name__, thread.daemon) for thread in threading.enumerate()])
""",
    'logging and warnings': """
import logging, warnings
for name in ('', 'tornado', 'asyncio', 'matplotlib', 'ipykernel', 'traitlets'):
    logger = logging.getLogger(name)
    print(name, logger.level, logger.disabled, logger.propagate,
          [type(handler).__name__ for handler in logger.handlers])
# those that an import has added aside
print(sorted({str(f) for f in warnings.filters if 'numpy' not in str(f)}), logging.raiseExceptions)
""",
    'garbage collection': 'import gc; print(gc.isenabled(), gc.get_threshold(), gc.get_debug())',
    'IPython': """
ip = get_ipython()
print(type(ip), ip.kernel.ident != '', sorted(ip.magics_manager.magics['line']))
print(ip.ipython_dir, ip.profile_dir.location, ip.history_manager.enabled, ip.user_module)
print(sorted((e, [c.__qualname__ for c in cs]) for e, cs in ip.events.callbacks.items()))
""",
}  # fmt: skip
"""Code by which a cell may look at the kernel that it runs in."""


@pytest.mark.parametrize('code', LOOKS.values(), ids=LOOKS)
def test_a_forked_kernel_looks_like_a_started_one(forked, started, said, code):
    assert said(forked, code).splitlines() == said(started, code).splitlines()


def test_a_forked_kernel_is_in_the_namespaces_of_its_room_alone(forked, said):
    kinds = os.listdir('/proc/self/ns')
    own = {kind for kind in kinds if not kind.endswith('_for_children')} - {'time'}
    code = f"""
import os
for process in ('self', '1'):
    print({{kind: os.readlink(f'/proc/{{process}}/ns/{{kind}}') for kind in {sorted(own)}}})
"""
    of_kernel, of_room = map(ast.literal_eval, said(forked, code).splitlines())
    assert of_kernel == of_room
    ours = {kind: os.readlink(f'/proc/self/ns/{kind}') for kind in own}
    assert [kind for kind in own if of_kernel[kind] == ours[kind]] == []


MODULES = 'import sys; print(sorted(sys.modules))'
FOLDERS = """
import os, sys
print(sorted({os.path.dirname(getattr(m, '__file__', None) or '') for m in sys.modules.values()}))
"""


def test_a_forked_kernel_has_imported_more_but_nothing_of_the_grader(forked, started, said):
    in_forked = set(ast.literal_eval(said(forked, MODULES)))
    assert set(ast.literal_eval(said(started, MODULES))) <= in_forked
    assert {'rclpy', 'numpy', 'sensor_msgs.msg'} <= in_forked
    assert [name for name in in_forked if name.split('.')[0] in ('grader', 'nbgrader')] == []
    # nor under bare names, which modules of students may have as well
    folders = ast.literal_eval(said(forked, FOLDERS))
    assert [folder for folder in folders if Path(folder).is_relative_to(ROOT / 'grader')] == []


PLOT = """
import matplotlib, matplotlib.pyplot as plt
print(matplotlib.get_backend(), matplotlib.matplotlib_fname(), plt.get_backend())
print(sorted((key, str(value)) for key, value in matplotlib.rcParams.items()))
plt.plot([1, 2])
print(plt.get_fignums(), plt.isinteractive())
ip = get_ipython()
print(sorted((e, [c.__qualname__ for c in cs]) for e, cs in ip.events.callbacks.items()))
"""


def test_a_forked_kernel_plots_as_a_started_one(loop, forked, started):
    runs = [loop.run(kernel.run(PLOT, timeout_sec=60.0)) for kernel in (forked, started)]
    assert [o.output_type for o in runs[0].outputs] == ['stream', 'display_data']
    first, second = (run.outputs for run in runs)
    assert first[0].text == second[0].text
    assert first[1].data.keys() == second[1].data.keys()
    assert first[1].data['image/png'] == second[1].data['image/png']


# -- nothing is shared between kernels ------------------------------------------------------------

CHANCE = """
import random, numpy, uuid, tempfile, secrets, os, string
print(random.random(), numpy.random.rand(), numpy.random.default_rng().random(), uuid.uuid4(),
      secrets.token_hex(), tempfile.mktemp(), random.SystemRandom().random(), os.urandom(8),
      get_ipython().kernel.session.key, get_ipython().kernel.session.session)
"""


def test_two_kernels_draw_different_random_numbers(forked, own, said):
    assert not set(said(forked, CHANCE).split()) & set(said(own, CHANCE).split())


def memory_of(process):
    """Yield the memory of a process."""
    with (
        open(f'/proc/{process.pid}/maps') as maps,
        open(f'/proc/{process.pid}/mem', 'rb', 0) as memory,
    ):
        for line in maps:
            start, end = (int(address, 16) for address in line.split()[0].split('-'))
            try:
                memory.seek(start)
                yield memory.read(end - start)
            except (OSError, OverflowError):
                continue


def test_the_secrets_of_a_test_room_are_in_no_server_and_no_later_kernel(loop, said):
    sandbox, told = loop.run(opened(room='test', seed=SEED))
    (later_sandbox, later) = loop.run(opened(room='test', seed='another'))
    try:
        key = told._manager.session.key
        hidden = [SEED.encode(), key]
        assert any(SEED.encode() in part for part in memory_of(process_of(told)))  # it is seen
        server = server_of(told)
        assert server == server_of(later)
        for process in (server, process_of(later)):
            found = [text for text in hidden for part in memory_of(process) if text in part]
            assert found == [], process
    finally:
        loop.run(closed(sandbox, told))
        loop.run(closed(later_sandbox, later))


HOSTILE = """
import builtins, gc, os, random, sys
import numpy, rclpy, my_robot_basics.session.classroom
random.random = lambda: 4
builtins.hostile = rclpy.hostile = numpy.hostile = sys.hostile = True
sys.modules['my_robot_basics.two_link_kinematics'] = None
os.environ['HOSTILE'] = '1'
open('/tmp/hostile', 'w').close()
"""
HARMED = """
import builtins, os, random, sys, numpy, rclpy
print([hasattr(m, 'hostile') for m in (builtins, rclpy, numpy, sys)], random.random() == 4,
      'HOSTILE' in os.environ, os.path.exists('/tmp/hostile'),
      sys.modules['my_robot_basics.two_link_kinematics'] is None)
"""


def test_changes_made_in_one_kernel_do_not_reach_other_kernels(loop, forked, own, said):
    said(own, HOSTILE)
    assert 'True' in said(own, HARMED)
    assert server_of(own) == server_of(forked)
    sandbox, later = loop.run(opened())
    try:
        for kernel in (forked, later):
            assert 'True' not in said(kernel, HARMED)
    finally:
        loop.run(closed(sandbox, later))


TOUCH = """
import ctypes, os
call = ctypes.CDLL(None, use_errno=True).syscall
# ptrace, kill, pidfd_open
for number, arguments in (101, (16, PID)), (62, (PID, 0)), (434, (PID, 0)):
    print(number, call(number, *arguments))
print(os.path.exists('/proc/PID'))
"""


def test_a_kernel_reaches_neither_its_server_nor_another_kernel(forked, own, said):
    for process in (server_of(own), process_of(forked)):
        seen = said(own, TOUCH.replace('PID', str(process.pid)))
        assert seen.split() == ['101', '-1', '62', '-1', '434', '-1', 'False']
        assert process.is_running()


def test_the_file_of_python_itself_can_not_be_changed(forked, said):
    code = """
import os
for change in (lambda p: os.open(p, os.O_WRONLY), lambda p: os.chmod(p, 0o700)):
    try: change('/proc/self/exe'); print('changed')
    except OSError as error: print('refused')
"""
    assert said(forked, code).split() == ['refused', 'refused']


@pytest.mark.skipif(os.geteuid() != 0, reason='an ordinary user cannot become another one')
def test_root_gives_the_kernels_of_each_slot_a_user_of_its_own(forked, own):
    users = [set(process_of(kernel).uids()) for kernel in (forked, own)]
    assert users[0] != users[1]
    assert all(len(ids) == 1 for ids in users)
    slots = range(FIRST_SLOT, FIRST_SLOT + 100)
    assert {slot_user(slot) for slot in slots} > users[0] | users[1]
    assert {0} not in users


# -- the end of a kernel --------------------------------------------------------------------------


def pids(network):
    return [p for p in psutil.pids() if _network(p) == network]


def _network(pid):
    try:
        return os.readlink(f'/proc/{pid}/ns/net')
    except OSError:
        return None


@pytest.mark.parametrize(
    'code',
    ['import os; os._exit(0)', 'import os; os.kill(os.getpid(), 9)', 'import os; os.kill(-1, 9)'],
)
def test_a_room_ends_with_its_kernel(loop, code):
    sandbox, kernel = loop.run(opened())
    network = _network(sandbox._holder.pid)
    before = len(pids(network))
    linger = "import subprocess; subprocess.Popen(['sleep', '4243'], start_new_session=True)"
    loop.run(kernel.run(linger, timeout_sec=60.0))
    run = loop.run(kernel.run(f'{code}\nwhile True: pass', timeout_sec=5.0))
    lives = '-1' in code  # Linux spares the process that calls: its loop is interrupted
    assert (run.died, kernel.alive, run.timed_out) == (not lives, lives, lives)
    loop.run(kernel.stop())
    deadline = time.monotonic() + 60
    while len(pids(network)) > before - 4 and time.monotonic() < deadline:
        time.sleep(0.02)
    # bubblewrap, the room's keeper, the kernel, its parent
    assert len(pids(network)) == before - 4
    loop.run(sandbox.close())
    assert pids(network) == []


def test_a_kernel_that_can_not_enter_its_room_is_the_graders_failure(loop, monkeypatch):
    monkeypatch.setattr(fork_client, '_NAMESPACES', ('user', 'net'))
    with pytest.raises(RoomFailure, match='could not enter its room'):
        loop.run(opened())
