"""A program that imports once what each kernel of *Validate* needs, and forks kernels.

Each order is a line of JSON, `{"folder": …, "environment": {…}, "arguments": […]}`; the reply is
the process ID. The program ends when its standard input is closed, with its parent at the latest.
"""

import contextlib
import gc
import importlib
import json
import os
import random
import signal
import sys
import time
from pathlib import Path

_IMPORTS = (
    'ipykernel.kernelapp',
    'IPython.core.completerlib',
    'rclpy',
    'rclpy.executors',
    'rclpy.node',
    'geometry_msgs.msg',
    'sensor_msgs.msg',
    'std_msgs.msg',
    'my_robot_basics.exchange.probe',
    'my_robot_basics.exchange.responder',
    'my_robot_basics.checks.topics.topics',
)
"""None of these may call `classroom.enter`, start a Python thread or create a ZMQ context."""
_ASLEEP_SEC = 10.0


def main() -> None:
    """Import, then fork a kernel for each order; returns only in the forked kernels."""
    for name in _IMPORTS:
        importlib.import_module(name)
    _wait_for_other_threads()
    gc.collect()
    gc.freeze()  # else a garbage collection in a kernel would copy all memory pages
    signal.signal(signal.SIGCHLD, _forget_the_ended)
    for line in sys.stdin:
        pid = os.fork()
        if pid == 0:
            _become_a_kernel(json.loads(line))
            return
        print(pid, flush=True)
    sys.exit()


def _forget_the_ended(*_: object) -> None:
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def _wait_for_other_threads() -> None:
    """Wait until LTTng's threads sleep: then they hold no lock that a fork would copy."""
    deadline = time.monotonic() + _ASLEEP_SEC
    others = [task for task in os.listdir('/proc/self/task') if int(task) != os.getpid()]
    while not all(_is_asleep(task) for task in others):
        if time.monotonic() > deadline:
            raise RuntimeError('an import has started threads that do not come to rest')
        time.sleep(0.001)


def _is_asleep(task: str) -> bool:
    stat = Path('/proc/self/task', task, 'stat').read_text(encoding='utf-8')
    return stat.rpartition(')')[2].split()[0] == 'S'


def _become_a_kernel(order: dict) -> None:
    """Make this process like one that was started with the order's folder and so on."""
    os.setsid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for file in range(3):
        os.dup2(nowhere, file)
    os.chdir(order['folder'])
    os.environ.clear()
    # ipykernel ends when the process with this ID ends
    os.environ.update(order['environment'] | {'JPY_PARENT_PID': str(os.getppid())})
    sys.argv[1:] = order['arguments']
    random.seed()
    sys.modules['numpy'].random.seed()


if __name__ == '__main__':
    main()
    # only a forked kernel gets here
    from ipykernel.kernelapp import launch_new_instance

    launch_new_instance()
