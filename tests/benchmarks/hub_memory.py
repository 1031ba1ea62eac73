"""What a student takes of a hub's memory: `sudo .venv/bin/python tests/benchmarks/hub_memory.py`.

It sets up a hub with temporary folders and users, and lets each student log in, open a lesson and
follow the live arm. It prints the proportional set size (PSS) of all processes of a user, so that
shared memory is counted once. It needs root, because it adds users.
"""

import argparse
import sys
from pathlib import Path
from statistics import mean

import psutil

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / 'tests')]

from chromium import several_launched
from hub_browser import Kernel, log_in, wait_for_lab
from hub_machine import hub_machine

IMPORTS = 'import my_robot_basics.live, my_robot_basics.kinematics_publisher'
ARM = """
import time
from my_robot_basics.live import run, follow_arm
from my_robot_basics.kinematics_publisher import KinematicsPublisher
publisher = run(KinematicsPublisher)
follow_arm()
time.sleep(10)
"""


def main() -> None:
    """Print a line for each state of the students' servers."""
    parser = argparse.ArgumentParser(description=__doc__.partition(':')[0])
    parser.add_argument('--students', type=int, default=4, help='how many (4)')
    number = parser.parse_args().students
    with hub_machine(number) as machine, several_launched(1) as (browser,):
        pages = [log_in(browser, machine, student) for student in machine.students]
        for page in pages:
            wait_for_lab(page)
        # the contents page has started a kernel
        for page in pages:
            page.evaluate('jupyterapp.serviceManager.sessions.shutdownAll()')
        print(f'{number} students, MB of each at the mean and at most')
        tell('a server in its room', machine.students)
        kernels = [Kernel(page) for page in pages]
        for kernel in kernels:
            kernel.run('1')
        tell('and a kernel', machine.students)
        for kernel in kernels:
            kernel.run(IMPORTS)
        tell('and what a lesson imports', machine.students)
        for kernel in kernels:
            kernel.run(ARM)
        tell('and the live arm', machine.students)


def tell(state: str, students: tuple[str, ...]) -> None:
    """Print the memory of the students' processes in a state."""
    taken = [pss_mb(student) for student in students]
    print(f'{state:<28}{mean(taken):>6.0f}{max(taken):>6.0f}', flush=True)


def pss_mb(user: str) -> float:
    """Return the PSS of all processes of a user in MB."""
    processes = [p for p in psutil.process_iter(['username']) if p.info['username'] == user]
    return sum(process.memory_full_info().pss for process in processes) / 1e6


if __name__ == '__main__':
    main()
