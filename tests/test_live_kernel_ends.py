"""How a kernel with nodes ends, and what it gives back: its domain, and its place on the graph."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import rclpy
from live_lesson import TALKER, Lesson, opened_lesson, stop_nodes_after
from rclpy.node import Node


@pytest.fixture(scope='module')
def lesson():
    yield from opened_lesson()


@pytest.fixture(autouse=True)
def nothing_runs(request):
    yield from stop_nodes_after(request)


@pytest.mark.slow
def test_two_kernels_have_two_domains_and_give_them_back(lesson):
    mine = int(lesson.value('classroom.enter()'))
    other = Lesson(TALKER)
    theirs = int(other.value('classroom.enter()'))
    assert mine != theirs
    other.run('talker = run(Talker)')
    with Witness(theirs) as witness:
        assert witness.sees('talker', present=True)
        returncode, stderr = other.shut_down()
        assert returncode == 0
        assert 'terminate called' not in stderr
        # nobody had to wait for the lease of a dead participant to run out
        assert witness.sees('talker', present=False, timeout_sec=4)
        assert '/talk' not in dict(witness.node.get_topic_names_and_types())


def claim_of(domain_id):
    """The socket that holds a domain; another kernel of this machine may take it next."""
    name = f'@my_robot_basics.domain.{domain_id}'
    rows = [line.split() for line in Path('/proc/net/unix').read_text().splitlines()]
    return [row[6] for row in rows if row[-1] == name]


def test_a_killed_kernel_gives_its_domain_back_though_its_child_lives():
    lesson = Lesson(TALKER)
    domain_id = lesson.value('classroom.enter()')
    start = "__import__('subprocess').Popen(['sleep', '60'], start_new_session=True).pid"
    child = int(lesson.value(start))
    claim = claim_of(domain_id)
    assert claim
    try:
        os.kill(lesson.manager.provisioner.pid, signal.SIGKILL)
        lesson.manager.provisioner.process.wait()
        os.kill(child, 0)
        assert claim_of(domain_id) != claim
    finally:
        os.kill(child, signal.SIGKILL)
        lesson.client.stop_channels()
        lesson.manager.shutdown_kernel(now=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    'unruly',
    [
        'class Unruly(Talker):\n    def tick(self): __import__("time").sleep(60)\nrun(Unruly)',
        'class Unruly(Talker):\n    def tick(self):\n        while True: pass\nrun(Unruly)',
        'rclpy.init(); own = Talker()\n'
        '__import__("threading").Thread(target=rclpy.spin, args=(own,), daemon=True).start()',
        'rclpy.init(); own = Talker(); run(Talker)',
    ],
    ids=['sleeps', 'never_returns', 'own_thread', 'never_spun'],
)
def test_unruly_nodes_do_not_abort_the_kernel_when_it_ends(unruly):
    lesson = Lesson(TALKER, unruly)
    returncode, stderr = lesson.shut_down()
    assert returncode == 0
    assert 'terminate called' not in stderr


@pytest.mark.slow
def test_a_restarted_kernel_runs_the_lesson_again(lesson):
    lesson.run('run(Talker)')
    lesson.restart()
    assert lesson.run(TALKER).error is None
    assert lesson.run('talker = run(Talker)').stdout == ''
    assert lesson.value('publishers(), alive(talker)') == "(['talker'], True)"


class Witness:
    """A node of another process than the kernel's, in the kernel's domain."""

    def __init__(self, domain_id):
        self.context = rclpy.Context()
        self.context.init(domain_id=domain_id)
        self.node = Node('_witness', context=self.context)

    def __enter__(self):
        return self

    def __exit__(self, *exc_info):
        self.node.destroy_node()
        self.context.shutdown()

    def sees(self, name, *, present, timeout_sec=10):
        deadline = time.monotonic() + timeout_sec
        while (name in self.node.get_node_names()) is not present:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.02)
        return True


@pytest.mark.slow
def test_a_script_runs_nodes_and_ends_cleanly(tmp_path):
    script = tmp_path / 'script.py'
    script.write_text(
        TALKER + "faulty = type('Faulty', (Talker,), {'tick': lambda self: 1 / 0})\n"
        'talker = run(Talker)\nassert alive(talker)\nrun(faulty)\n'
        'import time; time.sleep(0.3)\nprint(publishers())\n'
    )
    result = subprocess.run([sys.executable, script], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, '')
    assert '[talker]: made with x' in result.stdout
    assert 'ZeroDivisionError: division by zero' in result.stdout
    assert "['talker']" in result.stdout
