"""A worker process that grades without rooms, and does what an answer's first line asks for.

`# die`: is killed; `# die once FILE`: is killed unless the file exists, and makes it first;
`# stop FILE`: is stopped, once, too; `# wait FILE`: waits for the file; `# fail`: raises;
`# child`: tells what a process that it starts has open.
"""

import asyncio
import os
import signal
import subprocess
import sys
from pathlib import Path

from course_maker import executed

from grader import task, worker
from grader.execute import Execution

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
        case ['#', 'fail']:
            raise OSError('no room')
        case ['#', 'child']:
            look = 'import os; print(*sorted(map(int, os.listdir("/proc/self/fd")))[:-1])'
            child = subprocess.run(
                [sys.executable, '-c', look], close_fds=False, capture_output=True, text=True
            )
            handles = child.stdout.strip()
    reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
    notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
    notebook.metadata.setdefault('my_robot_basics', {})['seed'] = f'{seed} {os.getpid()}'
    notebook.metadata['my_robot_basics']['handles'] = handles
    return Execution(notebook=notebook, verdicts=(), notes=())


def _first(mark):
    try:
        Path(mark).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


if __name__ == '__main__':
    task.executed = look
    worker.main(sys.argv[1])
