"""One ROS domain per kernel: the first to claim a domain holds it, until its process ends."""

import os
import signal
import subprocess
import sys
import time

import pytest
from my_robot_basics.session import domain
from my_robot_basics.session.errors import NoFreeDomain


@pytest.fixture(autouse=True)
def few_domains(monkeypatch):
    """Three domains that no real kernel ever claims."""
    first = 100_000 + 10 * os.getpid()
    monkeypatch.setattr(domain, 'FIRST', first)
    monkeypatch.setattr(domain, 'LAST', first + 2)
    return first


def test_each_claim_gets_the_first_free_domain(few_domains):
    one, two = domain.claim(), domain.claim()
    assert (one.domain_id, two.domain_id) == (few_domains, few_domains + 1)
    one.release()
    one.release()
    assert domain.claim().domain_id == few_domains


def test_domains_are_claimed_from_1_to_101():
    code = 'from my_robot_basics.session import domain; print(domain.FIRST, domain.LAST)'
    assert _python(code).split() == ['1', '101']


def test_an_error_says_that_all_domains_are_taken():
    claims = [domain.claim() for _ in range(3)]
    with pytest.raises(NoFreeDomain, match=r'all 3 ROS domains .* shut down kernels'):
        domain.claim()
    claims.pop().release()
    domain.claim()


def test_an_error_shows_one_line_in_a_notebook():
    error = NoFreeDomain('all taken')
    assert error._render_traceback_() == ['NoFreeDomain: all taken']


@pytest.mark.parametrize('child', ['started', 'forked'])
def test_a_killed_holder_frees_its_domain_though_its_child_lives(few_domains, child):
    start = {
        'started': 'subprocess.Popen(["sleep", "30"], stdout=subprocess.DEVNULL, close_fds=False)'
        '; pid = child.pid',
        'forked': 'os.fork(); pid = child or (os.close(1), time.sleep(30), os._exit(0))',
    }[child]
    code = f"""
import os, subprocess, time
from my_robot_basics.session import domain
domain.FIRST, domain.LAST = {few_domains}, {few_domains + 2}
claim = domain.claim()
child = {start}
print(claim.domain_id, pid, flush=True)
time.sleep(30)
"""
    holder = subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE, text=True)
    domain_id, child_pid = map(int, holder.stdout.readline().split())
    try:
        assert domain_id == few_domains
        assert domain.claim().domain_id == few_domains + 1
        holder.kill()
        holder.wait()
        os.kill(child_pid, 0)  # the child does live
        # on a busy machine the domain may become free only a moment later
        deadline = time.monotonic() + 10
        while (free := domain.claim().domain_id) != few_domains and time.monotonic() < deadline:
            time.sleep(0.02)
        assert free == few_domains
    finally:
        os.kill(child_pid, signal.SIGKILL)
        holder.stdout.close()


def test_a_forked_child_does_not_free_the_domain_of_its_parent(few_domains):
    claim = domain.claim()
    pid = os.fork()
    if pid == 0:
        os._exit(0 if domain.claim().domain_id == few_domains + 1 else 1)
    assert os.waitpid(pid, 0)[1] == 0
    assert claim.domain_id == few_domains
    assert domain.claim().domain_id == few_domains + 1


def test_claiming_needs_no_rclpy():
    code = (
        'import sys; from my_robot_basics.session.domain import claim\n'
        'print("rclpy" in sys.modules)'
    )
    assert _python(code) == 'False\n'


def _python(code):
    return subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, check=True
    ).stdout
