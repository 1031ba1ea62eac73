"""What student code finds in its room, what it can't reach from there, and what outlives it."""

import asyncio
import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

from grader.common.errors import RoomFailure
from grader.course import ROOT
from grader.kernels.kernels import GradingKernel
from grader.sandbox import bubblewrap, cgroups, memory_watch
from grader.sandbox import sandbox as module
from grader.sandbox.bubblewrap import FIRST_USER, slot_user
from grader.sandbox.kernel_paths import KernelPaths
from grader.sandbox.limits import ROOM_DISK_BYTES, ROOM_FILES, ROOM_TERMINALS, process_limits
from grader.sandbox.sandbox import Sandbox
from grader.sandbox.seccomp import PROTOCOLS

pytestmark = pytest.mark.isolation

SLOTS = iter(range(200, 300))
"""None that a claimed ROS domain gives."""


@pytest.fixture(scope='module')
def loop():
    with asyncio.Runner() as runner:
        yield runner


@pytest.fixture
def sandbox(loop):
    """A sandbox of one test's own."""
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    yield sandbox
    loop.run(sandbox.close())


@pytest.fixture(scope='module')
def shared(loop):
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    yield sandbox
    loop.run(sandbox.close())


def begin(sandbox, code, *, room='student'):
    """Start Python in a room, told what a kernel there is told."""
    paths = sandbox.paths(room)
    return subprocess.Popen(
        [*paths.prefix, sys.executable, '-c', code],
        env=paths.environment | {'LD_LIBRARY_PATH': os.environ.get('LD_LIBRARY_PATH', '')},
        pass_fds=paths.pass_fds,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def run(sandbox, code, *, room='student'):
    """Return what Python printed in a room."""
    return begin(sandbox, code, room=room).communicate(timeout=120)[0].strip()


@pytest.fixture(params=['started', 'forked'])
def inside(request, loop):
    """Return what Python printed in a room: a process of its own, or a kernel that was forked."""

    async def in_a_kernel(sandbox, code, room):
        kernel = GradingKernel(room=room, domain_id=0, paths=sandbox.paths(room))
        await kernel.start()
        assert kernel.why_not_forked == ''
        ran = await kernel.run(code, timeout_sec=120.0)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(KernelPaths, 'remove', lambda paths: None)  # others will live there
            await kernel.stop()
        return ''.join(o.get('text', '') or o.evalue for o in ran.outputs).strip()

    def inside(sandbox, code, *, room='student'):
        if request.param == 'started':
            return run(sandbox, code, room=room)
        return loop.run(in_a_kernel(sandbox, code, room))

    return inside


WALK = """
import os
for folder, folders, files in os.walk('/'):
    folders[:] = [f for f in folders if os.path.join(folder, f) not in SKIPPED]
    for name in files + folders:
        path = os.path.join(folder, name)
        print(WHAT)
"""
PYTHONS = [str(f) for p in (sys.prefix, sys.base_prefix) for f in Path(p).iterdir() if f.is_dir()]
"""Thousands of files, and no place for others."""


@pytest.mark.parametrize('room', ['student', 'test'])
def test_the_course_and_the_machines_own_are_not_there(shared, tmp_path, room, inside):
    (tmp_path / 'canary.txt').write_text('x')
    code = WALK.replace('SKIPPED', repr(('/proc', '/usr', '/dev', *PYTHONS))).replace(
        'WHAT', 'path'
    )
    seen = inside(shared, code, room=room).splitlines()
    below = {p.removeprefix(f'{ROOT}/').split('/')[0] for p in seen if p.startswith(f'{ROOT}/')}
    assert below == {'.venv', 'my_robot_basics'}
    names = {Path(path).name for path in seen if not path.startswith(sys.prefix)}
    assert not names & {'canary.txt', 'gradebook.db', 'course_secret'}
    assert '/etc/shadow' not in seen
    tops = {path.split('/')[1] for path in seen}
    assert tops <= {
        *('bin', 'sbin', 'lib', 'lib32', 'lib64', 'libx32', 'usr', 'etc', 'proc', 'dev'),
        *('tmp', 'room', ROOT.parts[1], Path(sys.base_prefix).parts[1]),
    }


def test_only_a_small_disk_can_be_written_to(shared, inside):
    what = 'not os.path.islink(path) and os.access(path, os.W_OK)'
    code = WALK.replace('SKIPPED', "('/proc',)").replace('print(WHAT)', f'if {what}: print(path)')
    devices = ('/dev/null', '/dev/zero', '/dev/full', '/dev/random', '/dev/urandom', '/dev/tty')
    devices += ('/dev/pts', '/dev/ptmx')
    writable = {p for p in inside(shared, code).splitlines() if p and not p.startswith(devices)}
    roots = ('/tmp', '/dev/shm', '/room/home', '/room/kernel')
    assert {path for path in writable if not path.startswith(roots)} == set()
    assert set(roots) <= writable


STATUS = """
import os
for line in open('/proc/self/status'):
    print(line.strip())
print('ids:', os.getuid(), os.getgid())
print('processes:', [p for p in os.listdir('/proc') if p.isdigit()])
for kind in ('user', 'mnt', 'net', 'pid', 'ipc', 'uts'):
    print(kind + ':', os.readlink(f'/proc/self/ns/{kind}'))
print('network:', [line.split(':')[0].strip() for line in open('/proc/net/dev')][2:])
"""


def status(sandbox, room='student', look=run):
    lines = look(sandbox, STATUS, room=room).splitlines()
    return {k: v.strip() for k, _, v in (line.partition(':') for line in lines)}


def test_a_room_has_no_rights(shared, inside):
    seen = status(shared, look=inside)
    assert {seen[f'Cap{kind}'] for kind in ('Inh', 'Prm', 'Eff', 'Bnd', 'Amb')} == {'0' * 16}
    assert (seen['NoNewPrivs'], seen['Seccomp']) == ('1', '2')
    assert seen['ids'] == '1000 1000'


def stays(stack):
    """Look as `run` does, at rooms that stay: the numbers of one that has gone are given again."""

    def look(sandbox, code, *, room):
        code += "print('.', flush=True); import time; time.sleep(1000)"
        process = begin(sandbox, code, room=room)
        stack.enter_context(process)
        stack.callback(process.kill)
        return ''.join(iter(process.stdout.readline, '.\n'))

    return look


def test_a_room_has_namespaces_of_its_own_and_shares_only_the_network(shared, sandbox):
    with contextlib.ExitStack() as stack:
        look = stays(stack)
        student, test, next_door = (
            status(*room, look=look) for room in [(shared,), (shared, 'test'), (sandbox,)]
        )
    kinds = ('user', 'mnt', 'net', 'pid', 'ipc', 'uts')
    assert [k for k in kinds if student[k] == test[k]] == ['net']
    for kind in kinds:
        assert student[kind] != os.readlink(f'/proc/self/ns/{kind}')
        assert student[kind] != next_door[kind]
    assert student['network'] == "['lo']"
    assert student['processes'] == "['1', '2']"


@pytest.mark.skipif(os.geteuid() != 0, reason='an ordinary user cannot become another one')
def test_root_gives_each_slot_a_user_of_its_own(loop):
    users = []
    for slot in (301, 302):
        sandbox = Sandbox(slot=slot)
        loop.run(sandbox.open())
        try:
            sleeping = begin(sandbox, "import time; print('.', flush=True); time.sleep(1000)")
            assert sleeping.stdout.read(1) == '.'
            (users_of,) = [
                process.uids()
                for process in psutil.Process(sleeping.pid).children(recursive=True)
                if process.name().startswith('python')
            ]
            users.append(set(users_of))
        finally:
            loop.run(sandbox.close())
        sleeping.wait(30)
    assert users == [{slot_user(301)}, {slot_user(302)}]


RANGES = {
    '0 0 4294967295': FIRST_USER + 7,
    '0 100000 65536': 65_528,
    '0 1000 1': None,
    '0 1000 1\n1 100000 65536': 65_529,
}


@pytest.mark.parametrize(('mapped', 'user'), RANGES.items())
def test_a_slots_user_is_one_that_the_container_has(monkeypatch, mapped, user):
    monkeypatch.setattr(module.Path, 'read_text', lambda self: mapped)
    monkeypatch.setattr(os, 'geteuid', lambda: 0)
    assert slot_user(7) == user
    monkeypatch.setattr(os, 'geteuid', lambda: 1000)
    assert slot_user(7) is None


REACH = """
import socket
def reach(family, address):
    try:
        with socket.socket(family, socket.SOCK_STREAM) as s:
            s.settimeout(3)
            s.connect(address)
        return 'reached'
    except OSError as error:
        return type(error).__name__
print(reach(socket.AF_INET, ('127.0.0.1', PORT)), reach(socket.AF_INET, ('192.0.2.1', 80)),
      reach(socket.AF_UNIX, ABSTRACT), end=' ')
try:
    print(socket.getaddrinfo('example.org', 80))
except OSError as error:
    print(type(error).__name__)
"""


def test_nothing_outside_is_reached_by_network(shared, inside):
    abstract = f'\0a-socket-of-the-machine-{os.getpid()}'
    with (
        socket.create_server(('127.0.0.1', 0)) as server,
        socket.socket(socket.AF_UNIX) as local,
    ):
        local.bind(abstract)
        local.listen()
        code = REACH.replace('PORT', str(server.getsockname()[1]))
        code = code.replace('ABSTRACT', repr(abstract))
        assert (
            inside(shared, code)
            == 'ConnectionRefusedError OSError ConnectionRefusedError gaierror'
        )
        outside = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
        words = outside.stdout.split()
        assert (words[0], words[2]) == ('reached', 'reached')  # so it can be seen


NUMBERS = {
    'acct': 163, 'add_key': 248, 'bpf': 321, 'chroot': 161, 'clone3': 435, 'fanotify_init': 300,
    'file_setattr': 469, 'init_module': 175, 'inotify_init1': 294, 'io_setup': 206,
    'io_uring_setup': 425, 'keyctl': 250, 'memfd_create': 319, 'modify_ldt': 154, 'mount': 165,
    'mq_open': 240, 'msgget': 68, 'name_to_handle_at': 303, 'personality': 135, 'ptrace': 101,
    'quotactl': 179, 'semget': 64, 'setns': 308, 'shmget': 29, 'sync': 162, 'syslog': 103,
    'unshare': 272, 'userfaultfd': 323, 'vmsplice': 278, 'one that nobody has': 1_000,
}  # fmt: skip
"""Some system calls that are not allowed."""
CALLS = f"""
import ctypes, errno
call = ctypes.CDLL(None, use_errno=True).syscall
for name, number in {NUMBERS!r}.items():
    call(number, *[ctypes.c_long(-1)] * 5)
    if ctypes.get_errno() != errno.ENOSYS:
        print(name, errno.errorcode[ctypes.get_errno()])
import socket
for family in range(1, 46):
    for protocol in (*range(64), 132, 136, 262):
        for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM, socket.SOCK_RAW):
            try:
                socket.socket(family, kind, protocol).close()
                print('socket', family, protocol)
            except OSError:
                pass
"""


def test_system_calls_that_nobody_needs_are_refused(shared, inside):
    said = inside(shared, CALLS).splitlines()
    assert [line for line in said if 'socket' not in line] == []
    sockets = {tuple(map(int, line.split()[1:])) for line in said}
    assert {(1, 0), (2, 0), (2, 6), (2, 17), (16, 0)} <= sockets
    # IPv6 may be missing
    assert sockets <= {
        (family, protocol) for family, all_ in PROTOCOLS.items() for protocol in all_
    }


ORDINARY_PROGRAM = """
import asyncio, concurrent.futures, ctypes, multiprocessing, os, shutil, signal, socket, sqlite3
import subprocess, tempfile, threading, time
from multiprocessing import shared_memory

folder = tempfile.mkdtemp()
with open(f'{folder}/a', 'w') as file: file.write('text')
shutil.copy2(f'{folder}/a', f'{folder}/b')
shutil.copytree(folder, f'{folder}-copy')
shutil.rmtree(folder)
assert subprocess.run('ls | sort', shell=True).returncode == 0
assert subprocess.run(['true'], start_new_session=True, close_fds=False).returncode == 0
fork = multiprocessing.get_context('fork')
with fork.Pool(2) as pool: assert pool.map(abs, [-1, 2]) == [1, 2]
value, lock, queue = fork.Value('i', 3), fork.Lock(), fork.Queue()
with lock: queue.put(value.value)
assert queue.get() == 3
memory = shared_memory.SharedMemory(create=True, size=1000)
memory.close(), memory.unlink()
with concurrent.futures.ThreadPoolExecutor() as pool: assert list(pool.map(abs, [-1])) == [1]
async def answer():
    server = await asyncio.start_server(lambda r, w: w.close(), '127.0.0.1', 0)
    reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
    assert await reader.read() == b''
    process = await asyncio.create_subprocess_exec('true')
    return await process.wait()
thread = threading.Thread(target=lambda: outcome.append(asyncio.run(answer())))
outcome = []
thread.start(), thread.join()
assert outcome == [0]
assert [name for _, name in socket.if_nameindex()] == ['lo']
sqlite3.connect('/tmp/database').execute('create table t (x)')
import numpy
numpy.linalg.svd(numpy.ones((100, 100)))
array = numpy.memmap('/tmp/memmap', shape=(10,), mode='w+')
array[:] = 1
array.flush()
import matplotlib.pyplot
matplotlib.pyplot.figure().savefig('/tmp/figure.png')
matplotlib.pyplot.close()
os.sched_getaffinity(0), os.nice(1), os.getloadavg(), os.urandom(8), time.perf_counter()
print('all of it')
"""


@pytest.mark.parametrize('counted', [True, False])
def test_an_ordinary_program_runs_as_anywhere(loop, monkeypatch, inside, counted):
    if not counted:
        monkeypatch.setattr(module, '_sandbox_cgroups', lambda: None)
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    assert inside(sandbox, ORDINARY_PROGRAM).splitlines()[-1] == 'all of it'
    loop.run(sandbox.close())


HIDDEN = """
import ctypes, mmap, os
for make in (lambda: mmap.mmap(-1, 4096), lambda: mmap.mmap(os.open('/dev/zero', 2), 4096)):
    try: make(); print('hidden')
    except OSError as error: print(error.strerror)
for number in (29, 64, 68):
    print(ctypes.CDLL(None).syscall(number, 0, 100, 0o1600))
"""


def test_what_no_cgroup_counts_can_not_be_hidden(loop, monkeypatch, inside):
    monkeypatch.setattr(module, '_sandbox_cgroups', lambda: None)
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    said = inside(sandbox, HIDDEN).splitlines()
    assert said == ['Operation not permitted', 'No such device', '-1', '-1', '-1']
    loop.run(sandbox.close())


MERCY = """
import glob
for path in glob.glob('/proc/*/oom_*adj') + glob.glob('/proc/*/task/*/oom_*adj'):
    try:
        open(path, 'w').write('0')
        print('written', path)
    except OSError: pass
for process in ('self', '1'): print(open(f'/proc/{process}/oom_score_adj').read().strip())
"""


def test_who_ends_first_when_memory_runs_out_is_not_the_students_to_say(shared, inside):
    assert inside(shared, MERCY).split() == ['1000', '1000']


LIMITS = """
import resource
for number in range(16):
    print(number, *resource.getrlimit(number))
"""


def test_no_limit_is_inherited(shared, inside):
    said = [tuple(map(int, line.split())) for line in inside(shared, LIMITS).splitlines()]
    assert said == [(number, most, most) for number, most in sorted(process_limits().items())]
    assert len(said) == 16
    assert all(most >= 0 for _, most, _ in said)


BOMBS = {
    'processes': (
        'import os\nn = 0\ntry:\n  while True:\n    if os.fork() == 0:\n'
        '      import time; time.sleep(1000)\n    n += 1\n'
        'except BlockingIOError:\n  print(n < 256)',
        'True',
    ),
    'memory': ("try: bytearray(4 * 2**30)\nexcept MemoryError: print('no')", 'no'),
    'the disk': (
        "import os\ntry:\n  for i in range(1000):\n    for folder in ('/tmp', '/room/home', "
        "'/dev/shm', '/room/kernel'):\n      open(f'{folder}/{i}', 'wb').write(bytes(10**6))\n"
        'except OSError as e: print(e.strerror, i * 4)',
        f'No space left on device {ROOM_DISK_BYTES // 10**6 // 4 * 4}',
    ),
    'files': (
        "try:\n  for i in range(20_000): open(f'/tmp/{i}', 'w').close()\n"
        f'except OSError as e: print(e.strerror, i < {ROOM_FILES})',
        'No space left on device True',
    ),
    'a huge file': (
        'import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n'
        "try: open('/room/home/x', 'wb').truncate(10**10)\nexcept OSError as e: print(e.strerror)",
        'File too large',
    ),
    'descriptors': (
        "kept = []\ntry:\n  while True: kept.append(open('/dev/null'))\n"
        'except OSError as e: print(e.strerror)',
        'Too many open files',
    ),
    'terminals': (
        "import os; kept = []\ntry:\n  while True: kept.append(os.open('/dev/ptmx', os.O_RDWR))\n"
        'except OSError as e: print(e.strerror, len(kept))',
        f'No space left on device {ROOM_TERMINALS}',
    ),
    'locked memory': (
        'import ctypes; print(ctypes.CDLL(None).mlockall(3))',
        '-1',
    ),
    'an easy life when memory runs out': (
        "print(open('/proc/self/oom_score_adj').read())",
        '1000',
    ),
}


@pytest.mark.parametrize(('code', 'said'), BOMBS.values(), ids=BOMBS)
def test_a_room_can_use_up_only_its_share(sandbox, code, said):
    assert run(sandbox, code) == said
    # the other room has all of its own
    fine = (
        "open('/room/home/x', 'wb').write(bytes(30 * 10**6))\n"
        "import os; os.fork() and print('fine')"  # a child may not live to print
    )
    assert run(sandbox, fine, room='test') == 'fine'


SWELL = """
import os, time
for _ in range(3):
    if os.fork() == 0:
        kept = b'x' * 120_000_000
        print('full', flush=True)
        time.sleep(1000)
print(sorted(os.wait()[1] for _ in range(2)), flush=True)
"""


SMALL = "kept = b'x' * 150_000_000; import time; time.sleep(1000)"


@pytest.mark.parametrize('counted', ['by a cgroup', 'by looking'])
def test_processes_share_one_limit_of_memory(loop, monkeypatch, counted):
    for each in (cgroups, memory_watch):
        monkeypatch.setattr(each, 'ROOM_MEMORY_BYTES', 200_000_000)
    if counted == 'by looking':
        monkeypatch.setattr(module, '_sandbox_cgroups', lambda: None)
    sandbox = Sandbox(slot=next(SLOTS))

    async def swell():
        await sandbox.open()
        test_room = begin(sandbox, SMALL, room='test')
        room = begin(sandbox, SWELL)
        said = await asyncio.to_thread(room.stdout.read)
        await asyncio.to_thread(room.wait, 60)
        assert test_room.poll() is None  # it is larger than each, and in a room of its own
        await sandbox.close()
        test_room.wait(60)
        return said.splitlines()

    # one of the three has its place
    assert '[9, 9]' in loop.run(swell())


LINGER = """
import os, subprocess, sys, time
for _ in range(2):
    if os.fork():
        break
    os.setsid()
subprocess.Popen(['sleep', '4242'], start_new_session=True)
print('.', flush=True)
time.sleep(1000)
"""


def pids(network):
    found = []
    for pid in psutil.pids():
        with contextlib.suppress(OSError):
            if os.readlink(f'/proc/{pid}/ns/net') == network:
                found.append(pid)
    return found


@pytest.mark.parametrize('code', [LINGER, LINGER.replace('time.sleep(1000)', 'os._exit(0)')])
def test_nothing_outlives_the_sandbox(loop, code):
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    network = os.readlink(f'/proc/{sandbox._holder.pid}/ns/net')
    room = begin(sandbox, code)
    room.stdout.read(1)
    assert len(pids(network)) >= 1
    loop.run(sandbox.close())
    assert pids(network) == []
    room.wait(30)


GRADER = f"""
import asyncio, subprocess, sys, time
from grader.sandbox.sandbox import Sandbox
async def main():
    sandbox = Sandbox(slot=303)
    await sandbox.open()
    paths = sandbox.paths('student')
    code = "import subprocess, time; subprocess.Popen(['sleep', '1000'], start_new_session=True); "
    code += "print(flush=True); time.sleep(1000)"
    room = subprocess.Popen([*paths.prefix, {sys.executable!r}, '-c', code], text=True,
        env=paths.environment, pass_fds=paths.pass_fds, stdout=subprocess.PIPE)
    room.stdout.readline()
    print(sandbox._holder.pid, flush=True)
    time.sleep(1000)
asyncio.run(main())
"""


def test_nothing_outlives_a_grader_that_is_killed():
    grader = subprocess.Popen(
        [sys.executable, '-c', GRADER], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    network = os.readlink(f'/proc/{int(grader.stdout.readline())}/ns/net')
    assert len(pids(network)) > 4
    grader.send_signal(signal.SIGKILL)
    grader.wait()
    deadline = time.monotonic() + 60
    while pids(network) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert pids(network) == []


def test_a_kill_in_the_room_kills_only_the_room(shared):
    kill = 'import os\nos.fork()\nos.kill(-1, 9)\nos.kill(1, 9)\nos.kill(os.getpid(), 9)'
    witness = begin(shared, "print('.', flush=True); input()", room='test')
    assert witness.stdout.read(1) == '.'
    assert run(shared, kill) == ''
    assert begin(shared, 'print(1)').wait(60) == 0
    witness.communicate(timeout=60)


def test_a_terminal_is_out_of_reach(shared, inside):
    assert 'No such device or address' in inside(shared, "open('/dev/tty')")


def test_a_sandbox_that_can_not_be_made_is_the_graders_failure(loop, monkeypatch):
    monkeypatch.setattr(bubblewrap, '_HOLD', 'echo nothing works >&2; exit 1')
    sandbox = Sandbox(slot=next(SLOTS))
    with pytest.raises(RoomFailure, match='the sandbox could not be made: nothing works'):
        loop.run(sandbox.open())
    loop.run(sandbox.close())
    assert not any(folder.exists() for folder in sandbox._folders.values())


def test_a_closed_sandbox_leaves_no_file_and_no_descriptor(loop):
    before = None
    for _ in range(2):
        sandbox = Sandbox(slot=next(SLOTS))
        loop.run(sandbox.open())
        assert run(sandbox, 'print(1)') == '1'
        loop.run(sandbox.close())
        loop.run(sandbox.close())  # twice does no harm
        assert not any(folder.exists() for folder in sandbox._folders.values())
        descriptors = len(os.listdir('/proc/self/fd'))
        before = before or descriptors
    assert descriptors <= before


ORDINARY = 65_534


def as_ordinary_user(home, code):
    """Run Python as an ordinary user, who reaches no more of ours than the course."""
    home.chmod(0o777)
    code = f'import asyncio, sys\nsys.path.insert(0, {str(ROOT)!r})\n{code}\nasyncio.run(main())'
    reachable = ['--tmpfs', f'/{ROOT.parts[1]}', '--tmpfs', f'/{Path(sys.base_prefix).parts[1]}']
    for path in dict.fromkeys([str(ROOT), sys.prefix, sys.base_prefix]):
        reachable += ['--dir', path, '--ro-bind', path, path]
    return subprocess.run(
        [
            *('bwrap', '--dev-bind', '/', '/', *reachable),
            *('--cap-add', 'CAP_SETUID', '--cap-add', 'CAP_SETGID', '--'),
            *('setpriv', f'--reuid={ORDINARY}', f'--regid={ORDINARY}', '--clear-groups'),
            *(sys.executable, '-c', code),
        ],
        env={'PATH': os.environ['PATH'], 'HOME': str(home)},
        capture_output=True,
        text=True,
        cwd='/',
    )


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason='we are an ordinary user')
def test_an_ordinary_user_has_the_same_sandbox(tmp_path_factory):
    code = """
from grader.kernels.rooms import GradingRooms
async def main():
    async with GradingRooms() as rooms:
        run = await rooms.run_student_cell('import os; print(os.getuid()); x = 7', timeout_sec=60)
        print(run.outputs[0].text.strip())
        run = await rooms.run_check(
            'from my_robot_basics.checks import student; print(student.value("x"))')
        print(run.outputs[0].text.strip())
        print(rooms._student.why_not_forked or 'forked')
"""
    done = as_ordinary_user(tmp_path_factory.mktemp('home'), code)
    assert done.stdout.splitlines() == ['1000', '7', 'forked'], done.stderr


UNDER_WAY = """
import os, socket
kept = []
try:
    while True:
        kept.append(socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM))
        for _ in range(8): socket.send_fds(kept[-1][0], [b'x'], [0] * 100)
except OSError as error: print(error.strerror)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason='we are an ordinary user')
def test_files_on_their_way_in_one_room_stop_none_elsewhere(tmp_path_factory):
    code = f"""
import resource
resource.setrlimit(resource.RLIMIT_NOFILE, (1_024, 4_096))  # as for a login
from grader.kernels.rooms import GradingRooms
async def main():
    async with GradingRooms() as rooms:
        run = await rooms.run_student_cell({UNDER_WAY!r}, timeout_sec=60)
        print(run.outputs[0].text.strip())
        async with GradingRooms() as others:
            run = await others.run_student_cell('print("fine")', timeout_sec=60)
            print(run.outputs[0].text.strip())
"""
    done = as_ordinary_user(tmp_path_factory.mktemp('home'), code)
    said = ['Too many references: cannot splice', 'fine']
    assert done.stdout.splitlines() == said, done.stderr


def test_many_sandboxes_open_and_close_side_by_side(loop):
    async def once():
        sandbox = Sandbox(slot=next(SLOTS))
        await sandbox.open()
        await sandbox.close()

    async def all_at_once():
        await asyncio.gather(*(once() for _ in range(8)))

    threads = threading.active_count()
    loop.run(all_at_once())
    assert threading.active_count() <= threads + 1
