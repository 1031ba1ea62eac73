"""The rooms of an exercise reach each other through ROS alone."""

import asyncio

import pytest

from grader.kernels import fork_servers
from grader.kernels.rooms import GradingRooms

pytestmark = pytest.mark.isolation

LISTENERS = """
def rows(name): return [line.split() for line in open(f'/proc/net/{name}').read().splitlines()[1:]]
print('tcp', [row[1] for name in ('tcp', 'tcp6') for row in rows(name) if row[3] == '0A'])
print('raw', [row[1] for name in ('raw', 'raw6', 'packet') for row in rows(name)])
print('abstract', [row[7] for row in rows('unix') if len(row) > 7 and row[7].startswith('@')])
print('udp', len(rows('udp') + rows('udp6')))
"""
NODE = """
import rclpy
rclpy.init()
node = rclpy.create_node('listening')
"""
FORKS = """
import multiprocessing
process = multiprocessing.get_context('fork').Process(target=print, args=('from a child',))
process.start()
process.join()
import time
time.sleep(1.0)
"""


@pytest.fixture(scope='module', params=['forked', 'started'])
def rooms(request):
    with asyncio.Runner() as loop, pytest.MonkeyPatch.context() as patch:
        if request.param == 'started':
            for room in ('student', 'test'):
                patch.setitem(fork_servers._unfit, room, 'the test says so')
        opened = GradingRooms()
        loop.run(opened.__aenter__())
        yield lambda code: printed(loop.run(opened.run_student_cell(code, timeout_sec=30.0)))
        loop.run(opened.__aexit__())


def printed(run):
    assert run.ran_to_end, run.error
    return ''.join(output.text for output in run.outputs)


def test_only_ros_listens_in_the_shared_network(rooms):
    assert rooms(LISTENERS) == 'tcp []\nraw []\nabstract []\nudp 0\n'
    rooms(NODE)  # its participant listens over UDP
    others, udp = rooms(LISTENERS).split('udp ')
    assert others == 'tcp []\nraw []\nabstract []\n'
    assert int(udp) > 0


def test_the_output_of_a_forked_process_is_shown(rooms):
    assert rooms(FORKS) == 'from a child\n'
