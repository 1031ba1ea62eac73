"""How many lists of `ros2` are complete, and how long they take, against plain rclpy nodes.

    .venv/bin/python tests/benchmarks/ros2_complete.py [CALLS] [--beside CHECKOUT]

The nodes lack a lesson's discovery profile and range. Topics, the endpoints of one, and services
are listed in turn, each time in a new process. With CHECKOUT, another working copy of this
repository, its `ros2` runs the same in turn, so that both run under the same conditions. So does
one that discovers for half a second, as ros2cli does without its daemon. The first row is a
process that imports rclpy and makes a node, which every call needs. Nothing is asserted.
"""

import argparse
import itertools
import os
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tests'))

from ros2_command import OF_A_LESSON, own_domain, plain_nodes

START = 'my_robot_basics/my_robot_basics/ros2/start.py'
ONE_NODE = 'import rclpy; rclpy.init(); rclpy.create_node("_bare"); rclpy.shutdown()'
ANNOUNCED_SEC = 3.5
"""After that the nodes' first announcements are over; later ones come every 3 s."""
FLOOR = 'rclpy, one node'
HALF_A_SECOND = 'half a second'


@dataclass
class Tally:
    """The results of the calls of one kind."""

    complete: int = 0
    took_sec: list[float] = field(default_factory=list)


def main(calls: int, beside: Path | None) -> None:
    """Print a table for each number of nodes."""
    os.environ.setdefault('ROS_DOMAIN_ID', '0')
    ros2 = [sys.executable, '-P', ROOT / START, 'ros2.main']
    ways = {'this': (ros2, ()), HALF_A_SECOND: (ros2, ('--spin-time', '0.5'))}
    if beside:
        ways['beside'] = ([sys.executable, '-P', beside / START, 'ros2.main'], ())
    for nodes, contexts in ((3, 1), (7, 2)):
        with own_domain(), plain_nodes(nodes, contexts):
            time.sleep(ANNOUNCED_SEC)
            tallies = {way: Tally() for way in (FLOOR, *ways)}
            questions = itertools.cycle(answers(nodes).items())
            for words, expected in itertools.islice(questions, calls):
                tallies[FLOOR].took_sec.append(run([sys.executable, '-c', ONE_NODE])[0])
                for way, (command, more) in ways.items():
                    seconds, printed = run([*command, *words.split(), *more])
                    tallies[way].took_sec.append(seconds)
                    tallies[way].complete += printed == expected
        print(f'\n{nodes} nodes in {contexts} context{"s" * (contexts > 1)}')
        print(f'{"":15} complete of {calls:<4} median s   p90 s')
        for way, tally in tallies.items():
            complete = '' if way == FLOOR else tally.complete
            at_90 = statistics.quantiles(tally.took_sec, n=10)[-1]
            median = statistics.median(tally.took_sec)
            print(f'{way:15} {complete:>16} {median:8.2f} {at_90:7.2f}', flush=True)


def answers(nodes: int) -> dict[str, str]:
    """Return what each command prints if it has discovered everything."""
    own = [f'/topic_{n} [std_msgs/msg/String]' for n in range(nodes)]
    ros = [
        '/parameter_events [rcl_interfaces/msg/ParameterEvent]',
        '/rosout [rcl_interfaces/msg/Log]',
    ]
    ends = 'Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 1\n'
    return {
        'topic list -t': ''.join(f'{line}\n' for line in [*ros, *own]),
        f'topic info /topic_{nodes - 1}': ends,
        'service list -c': f'{8 * nodes}\n',
    }


def run(command: list[str | Path]) -> tuple[float, str]:
    """Run a process as in a plain shell; return its seconds and its output."""
    environment = {name: value for name, value in os.environ.items() if name not in OF_A_LESSON}
    began = time.perf_counter()
    done = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    return time.perf_counter() - began, done.stdout


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('calls', type=int, nargs='?', default=100)
    parser.add_argument('--beside', type=Path, metavar='CHECKOUT')
    args = parser.parse_args()
    main(args.calls, args.beside and args.beside.resolve())
