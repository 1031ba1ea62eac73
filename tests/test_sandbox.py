"""What student code finds in its room, and what it can't reach or change from there."""

import contextlib
import errno
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from inside_sandbox import SLOTS, begin, run

from grader.course import ROOT
from grader.kernels.kernels import GradingKernel
from grader.sandbox import sandbox as module
from grader.sandbox.kernel_paths import KernelPaths
from grader.sandbox.limits import process_limits
from grader.sandbox.sandbox import Sandbox
from grader.sandbox.seccomp import PROTOCOLS

pytestmark = pytest.mark.isolation


@pytest.fixture(params=['started', 'forked'])
def inside(request, loop):
    """Return what Python printed in a room: a process of its own, or a kernel that was forked."""

    async def in_a_kernel(sandbox, code, room):
        kernel = GradingKernel(room=room, domain_id=0, paths=sandbox.paths(room))
        await kernel.start()
        assert kernel.why_not_forked == ''
        ran = await kernel.run(code, timeout_sec=120.0)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(KernelPaths, 'remove', lambda paths: None)  # others need it
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
def test_private_files_of_the_course_and_the_machine_are_not_in_a_room(
    shared_sandbox, tmp_path, room, inside
):
    (tmp_path / 'canary.txt').write_text('x')
    code = WALK.replace('SKIPPED', repr(('/proc', '/usr', '/dev', *PYTHONS))).replace(
        'WHAT', 'path'
    )
    seen = inside(shared_sandbox, code, room=room).splitlines()
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


def test_a_room_can_write_only_to_its_own_temporary_folders(shared_sandbox, inside):
    what = 'not os.path.islink(path) and os.access(path, os.W_OK)'
    code = WALK.replace('SKIPPED', "('/proc',)").replace('print(WHAT)', f'if {what}: print(path)')
    devices = ('/dev/null', '/dev/zero', '/dev/full', '/dev/random', '/dev/urandom', '/dev/tty')
    devices += ('/dev/pts', '/dev/ptmx')
    writable = {
        p for p in inside(shared_sandbox, code).splitlines() if p and not p.startswith(devices)
    }
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


def test_a_room_has_no_capabilities_and_a_seccomp_filter(shared_sandbox, inside):
    seen = status(shared_sandbox, look=inside)
    assert {seen[f'Cap{kind}'] for kind in ('Inh', 'Prm', 'Eff', 'Bnd', 'Amb')} == {'0' * 16}
    assert (seen['NoNewPrivs'], seen['Seccomp']) == ('1', '2')
    assert seen['ids'] == '1000 1000'


def stays(stack):
    """Look as `run` does, at rooms that stay: Linux reuses the numbers of ended namespaces."""

    def look(sandbox, code, *, room):
        code += "print('.', flush=True); import time; time.sleep(1000)"
        process = begin(sandbox, code, room=room)
        stack.enter_context(process)
        stack.callback(process.kill)
        return ''.join(iter(process.stdout.readline, '.\n'))

    return look


def test_a_room_has_namespaces_of_its_own_and_shares_only_the_network(shared_sandbox, sandbox):
    with contextlib.ExitStack() as stack:
        look = stays(stack)
        student, test, next_door = (
            status(*room, look=look)
            for room in [(shared_sandbox,), (shared_sandbox, 'test'), (sandbox,)]
        )
    kinds = ('user', 'mnt', 'net', 'pid', 'ipc', 'uts')
    assert [k for k in kinds if student[k] == test[k]] == ['net']
    for kind in kinds:
        assert student[kind] != os.readlink(f'/proc/self/ns/{kind}')
        assert student[kind] != next_door[kind]
    assert student['network'] == "['lo']"
    assert student['processes'] == "['1', '2']"


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


def test_a_room_reaches_nothing_outside_by_network(shared_sandbox, inside):
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
            inside(shared_sandbox, code)
            == 'ConnectionRefusedError OSError ConnectionRefusedError gaierror'
        )
        outside = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
        words = outside.stdout.split()
        assert (words[0], words[2]) == ('reached', 'reached')  # from outside


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


def test_system_calls_and_sockets_that_are_not_allowed_are_refused(shared_sandbox, inside):
    said = inside(shared_sandbox, CALLS).splitlines()
    assert [line for line in said if 'socket' not in line] == []
    sockets = {tuple(map(int, line.split()[1:])) for line in said}
    assert {(1, 0), (2, 0), (2, 6), (2, 17), (16, 0)} <= sockets
    # IPv6 may be missing
    assert sockets <= {
        (family, protocol) for family, all_ in PROTOCOLS.items() for protocol in all_
    }


LEASES = """
import fcntl, os, sys
own = '/tmp/leased'
open(own, 'w').close()
for path in own, f'{sys.prefix}/pyvenv.cfg':
    file = os.open(path, os.O_RDONLY)
    for kind in fcntl.F_RDLCK, fcntl.F_WRLCK:
        try:
            fcntl.fcntl(file, fcntl.F_SETLEASE, kind)
            print('taken')
        except OSError as error:
            print(error.errno)
    os.close(file)
"""
"""A lease on a file makes every other program that opens it wait for 45 s. Linux gives one to
the file's owner, even if the file is mounted read-only."""


def test_no_lease_on_a_file_can_be_taken_in_a_room(shared_sandbox, inside):
    assert inside(shared_sandbox, LEASES).split() == [str(errno.EPERM)] * 4


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
def test_an_ordinary_program_runs_in_a_room(loop, monkeypatch, inside, counted):
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


def test_shared_memory_is_refused_where_no_cgroup_counts_it(loop, monkeypatch, inside):
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


def test_student_code_cannot_lower_its_oom_score(shared_sandbox, inside):
    assert inside(shared_sandbox, MERCY).split() == ['1000', '1000']


LIMITS = """
import resource
for number in range(16):
    print(number, *resource.getrlimit(number))
"""


def test_each_resource_limit_is_set_for_a_room_and_none_is_inherited(shared_sandbox, inside):
    said = [tuple(map(int, line.split())) for line in inside(shared_sandbox, LIMITS).splitlines()]
    assert said == [(number, most, most) for number, most in sorted(process_limits().items())]
    assert len(said) == 16
    assert all(most >= 0 for _, most, _ in said)


def test_the_terminal_of_the_grader_cannot_be_opened_in_a_room(shared_sandbox, inside):
    assert 'No such device or address' in inside(shared_sandbox, "open('/dev/tty')")
