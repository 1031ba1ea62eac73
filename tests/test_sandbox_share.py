"""How much of the machine a room can use up: processes, memory, disk, files."""

import asyncio

import pytest
from inside_sandbox import SLOTS, begin, run

from grader.sandbox import cgroups, memory_watch
from grader.sandbox import sandbox as module
from grader.sandbox.limits import ROOM_DISK_BYTES, ROOM_FILES, ROOM_TERMINALS
from grader.sandbox.sandbox import Sandbox

pytestmark = pytest.mark.isolation


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
    # the other room still has its whole share
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
def test_processes_of_a_room_share_one_memory_limit(loop, monkeypatch, counted):
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
        assert test_room.poll() is None  # larger than each of the others, but alone in its room
        await sandbox.close()
        test_room.wait(60)
        return said.splitlines()

    # one of the three fits into the limit
    assert '[9, 9]' in loop.run(swell())
