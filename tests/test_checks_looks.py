"""Rates: what each kind of node is judged by, and how. One process a node, as at grading."""

import contextlib
import subprocess
import sys
import time
from pathlib import Path

import pytest
from my_robot_basics.checks import CheckFailed, looks, topic

NODES = Path(__file__).with_name('nodes')
TOPIC = '/kinematics/joint_states'


@contextlib.contextmanager
def running(name):
    process = subprocess.Popen([sys.executable, NODES / f'{name}.py'], stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize(
    ('node', 'seconds', 'hz', 'messages'),
    [
        ('five_hz', 60.0, 5.0, 300),
        ('own_thread', 10.0, 5.0, 50),
        ('best_effort', 10.0, 5.0, 50),
        ('one_hz', 10.0, 1.0, 10),
        ('fifth_hz', 20.0, 0.2, 4),
        ('fifty_hz', 5.0, 50.0, 250),
    ],
)
def test_a_timer_is_judged_exactly_on_the_robots_clock(capfd, node, seconds, hz, messages):
    with running(node):
        recording = topic(TOPIC).record(seconds=seconds)
    recording.assert_rate(hz=hz)
    assert (recording.clock, len(recording.messages)) == ('simulated', messages)
    assert capfd.readouterr() == ('', '')


@pytest.mark.parametrize(
    ('node', 'seen'),
    [
        ('one_hz', r'1\.0 Hz over 10 s \(10 messages\)'),
        # only a timer explains the first; a thread that can't keep up would look like these
        ('too_slow', r'4\.[67]\d* Hz over 4 s'),
        ('too_fast', r'5\.[23]\d* Hz over 4 s'),
    ],
)
def test_a_wrong_rate_fails(node, seen):
    with running(node):
        recording = topic(TOPIC).record(seconds=10.0)
        assert recording.clock == 'simulated'
        with pytest.raises(
            CheckFailed, match=rf'expected 5\.0 Hz, saw {seen}.*: the timer period'
        ):
            recording.assert_rate(hz=5.0)
    # the node is gone, and so is the second opinion
    with pytest.raises(CheckFailed, match=r'saw .* Hz over 10 s'):
        recording.assert_rate(hz=5.0)


IGNORES = "note: /kinematics_publisher ignores the robot's clock (use_sim_time); judged on the wall clock\n"  # noqa: E501


@pytest.mark.parametrize(
    ('node', 'out'),
    [
        ('steady_clock', IGNORES),
        ('sleep_loop', IGNORES),
        ('unresponsive', ''),
        ('no_parameter_services', ''),
        ('multithreaded', ''),
        ('create_rate', ''),
    ],
)
def test_honest_nodes_that_are_no_plain_timers_pass(capfd, node, out):
    with running(node):
        recording = topic(TOPIC).record()
        recording.assert_rate(hz=5.0)
    assert capfd.readouterr() == (out, '')


@pytest.mark.parametrize(
    ('node', 'seen'),
    [('bursts', 'pauses of 1.0'), ('pairs', 'pauses of 0.4')],
)
def test_bursts_are_not_a_rate(node, seen):
    with running(node), pytest.raises(CheckFailed, match=seen):
        topic(TOPIC).record().assert_rate(hz=5.0)


@pytest.mark.parametrize('node', ['five_hz', 'one_hz'])
def test_a_node_is_alive_on_wall_time_after_a_check(node):
    with running(node):
        topic(TOPIC).record(seconds=10.0)
        message = topic(TOPIC).wait_for(timeout_sec=5.0)
        stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    # far from the time that the check had simulated: 10 s ahead
    assert abs(stamp - time.time()) < 5.0


@pytest.mark.parametrize('error', [KeyboardInterrupt, CheckFailed])
def test_a_node_is_alive_after_a_check_that_was_cut_short(monkeypatch, error):
    def interrupt(*args, **kwargs):
        raise error

    with running('five_hz'):
        monkeypatch.setattr(looks, '_find_step', interrupt)
        with pytest.raises(error):
            topic(TOPIC).record()
        topic(TOPIC).wait_for(timeout_sec=5.0)
