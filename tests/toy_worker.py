"""A worker process that grades without rooms, and does what an answer's first line says.

`# die`: is killed; `# die once FILE`: is killed, but only once: it creates the file first;
`# stop FILE`: is stopped (SIGSTOP), also only once; `# wait FILE`: waits for the file;
`# fail`: raises; `# child`: reports the open files of a process that it starts; `# endless`:
announces a result of 1 TB; `# loop FILE`: creates the file, and does not return to Python.
"""

import asyncio
import os
import re
import signal
import struct
import subprocess
import sys
from pathlib import Path

from given_verdicts import executed

from grader.judging import task
from grader.judging.execute import Execution
from grader.workers import worker

worker.BEAT_SEC = 0.1


async def look(notebook, *, extra_files=(), seed='', trust_students=False):
    handles = ''
    answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
    match answer.partition('\n')[0].split():
        case ['#', 'die']:
            os.kill(os.getpid(), signal.SIGKILL)
        case ['#', 'die', 'once', mark] if _first(mark):
            os.kill(os.getpid(), signal.SIGKILL)
        case ['#', 'stop', mark] if _first(mark):
            os.kill(os.getpid(), signal.SIGSTOP)
        case ['#', 'wait', mark]:
            while not Path(mark).exists():
                await asyncio.sleep(0.02)
        case ['#', 'loop', mark]:
            worker.DEAD_SEC = 1
            await asyncio.sleep(3 * worker.BEAT_SEC)
            Path(mark).touch()
            re.match('(a|a)*b', 100 * 'a')
        case ['#', 'fail']:
            raise OSError('no room')
        case ['#', 'endless']:
            endless.append(True)
        case ['#', 'child']:
            look = 'import os; print(*sorted(map(int, os.listdir("/proc/self/fd")))[:-1])'
            child = subprocess.run(
                [sys.executable, '-c', look], close_fds=False, capture_output=True, text=True
            )
            handles = child.stdout.strip()
    reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
    notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
    ours = notebook.metadata.setdefault('my_robot_basics', {})
    ours.update({'notes': [], 'seed': seed})
    told = f'note: {os.getpid()}\nnote: {handles}\n'
    notebook.cells[-2].outputs[0].text += told  # checks may print anything
    return Execution(notebook=notebook, verdicts=(), notes=())


send, endless = worker.send, []


async def claim(writer, number, text=''):
    if not (text and endless):
        await send(writer, number, text)
        return
    writer.write(struct.pack('>QQ', number, 10**12) + b'{"failed": "')
    while True:
        writer.write(b' ' * 1_000_000)
        await writer.drain()


def _first(mark):
    try:
        Path(mark).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


if __name__ == '__main__':
    task.execute_exercises, worker.send = look, claim
    worker.main(sys.argv[1])
