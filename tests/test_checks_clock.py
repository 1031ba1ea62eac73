"""Plain timers: exact on the clock that a check drives, and back on wall time after it."""

import contextlib
import threading
import time
import types

import pytest
from my_robot_basics.checks import CheckFailed, topic
from my_robot_basics.checks.clock import barriers, clock, clock_budget, clock_use, due_ticks
from my_robot_basics.checks.topics import driven_topic, drives, sampling
from my_robot_basics.exchange import student
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import pressure
from nodes.running import imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock as RclpyClock
from rclpy.clock import ClockType
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import Empty

TOPIC = '/kinematics/joint_states'
SLOWEST_MEDIAN_SEC = barriers.SLOWEST_MEDIAN_SEC
"""The value for a student: the fixture `patient` raises it for the tests here."""


pytestmark = pytest.mark.usefixtures('patient')


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


@pytest.mark.slow
@pytest.mark.parametrize('node', ['five_hz', 'one_hz'])
def test_a_node_is_alive_on_wall_time_after_a_check(node):
    with running(node):
        topic(TOPIC).record(seconds=10.0)
        message = topic(TOPIC).wait_for(timeout_sec=5.0)
        stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    # far from the time that the check had simulated: 10 s ahead
    assert abs(stamp - time.time()) < 5.0


@pytest.mark.slow
@pytest.mark.parametrize('error', [KeyboardInterrupt, CheckFailed])
def test_a_node_is_alive_after_a_check_that_was_cut_short(monkeypatch, error):
    def interrupt(*args, **kwargs):
        raise error

    with running('five_hz'):
        monkeypatch.setattr(drives, '_find_step', interrupt)
        with pytest.raises(error):
            topic(TOPIC).record()
        topic(TOPIC).wait_for(timeout_sec=5.0)


@contextlib.contextmanager
def spinning(make_node):
    """A node in this process that is spun in a thread for the duration of a with statement."""
    with Context() as context:
        node = make_node(context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin)
        thread.start()
        try:
            yield node
        finally:
            executor.shutdown()
            thread.join()
            node.destroy_node()


@pytest.mark.slow
def test_a_check_waits_for_a_node_that_is_slow_to_return():
    # otherwise the next check finds it frozen, on a clock that nobody drives any more
    slow_to_return = imported('slow_to_return').SlowToReturn
    with spinning(lambda context: slow_to_return(context=context)) as node:
        topic(TOPIC).record(seconds=1.0)
        assert node.returned


class AdaptiveSemaphore(ReentrantCallbackGroup):
    """Lets no callback through while it is closed, as an executor whose threads are all busy."""

    is_closed = False

    def can_execute(self, entity):
        return not self.is_closed and super().can_execute(entity)


def test_a_timer_due_when_the_simulated_clock_ends_fires_on_wall_time():
    # rcl carries over what is left of the period, unless that is exactly nothing
    gate, fired = AdaptiveSemaphore(), threading.Event()

    def make_node(context):
        node = Node('late', context=context)
        node.create_timer(0.2, fired.set, callback_group=gate)
        # on a steady clock: the executor wakes up at any time and sees that the gate is open
        node.create_timer(0.1, lambda: None, clock=RclpyClock(clock_type=ClockType.STEADY_TIME))
        return node

    with spinning(make_node), Watcher() as watcher:
        with clock.SimulatedClock(watcher, needed={'/late'}) as simulated:
            simulated.tick(60 * 10**9)
            # a clock that goes back sets the timer anew: its next call is exactly 0.2 s ahead
            simulated.tick(-(10**9))
            gate.is_closed = True
            simulated.tick(2 * 10**8)
        gate.is_closed = False
        fired.clear()
        assert fired.wait(10.0)


def test_timers_that_take_turns_still_do_so_after_a_check():
    # on a clock that goes back, rcl starts all timers anew, and both would fire at once
    fired = []

    def make_node(context):
        node = Node('by_turns', context=context)
        node.create_timer(0.4, lambda: fired.append('even'))
        time.sleep(0.2)
        node.create_timer(0.4, lambda: fired.append('odd'))
        return node

    with spinning(make_node), Watcher() as watcher:
        with clock.SimulatedClock(watcher, needed={'/by_turns'}) as simulated:
            simulated.tick(10**9)
        with clock.SimulatedClock(watcher, needed={'/by_turns'}) as simulated:
            simulated.tick(10**9)
            in_ticks = []
            for _ in range(12):
                fired.clear()
                simulated.tick(10**8)
                in_ticks.append(len(fired))
    assert max(in_ticks) == 1
    assert sum(in_ticks) == 6


def test_a_clock_publisher_that_only_the_notebook_knows_prevents_simulation(monkeypatch):
    monkeypatch.setattr(student, 'publishes', lambda topic_name: topic_name == '/clock')
    with Watcher() as watcher, pytest.raises(clock.Inconclusive, match='another node publishes'):
        clock.SimulatedClock(watcher, needed=set()).__enter__()


@pytest.mark.parametrize('was_switched', [False, True])
def test_a_node_that_waits_for_a_clock_of_its_own_accord_fails(monkeypatch, was_switched):
    # after a check that was not able to switch it back, it is not the node's own doing
    monkeypatch.setattr(clock_use, '_switched', {'/late'} if was_switched else set())
    late = Parameter('use_sim_time', value=True)
    fails = pytest.raises(CheckFailed, match='leave use_sim_time out')
    with (
        spinning(lambda context: Node('late', context=context, parameter_overrides=[late])),
        Watcher() as watcher,
        contextlib.nullcontext() if was_switched else fails,
        clock.SimulatedClock(watcher, needed={'/late'}) as simulated,
    ):
        simulated.tick(10**8)
    assert clock_use._switched == {'/late'}


def test_a_clock_publisher_that_appears_during_simulation_stops_it():
    with Watcher() as watcher, clock.SimulatedClock(watcher, needed=set()) as simulated:
        simulated.tick(10**8)
        watcher.node.create_publisher(ClockMessage, '/clock', 10)
        with pytest.raises(clock.Inconclusive, match='another node publishes /clock'):
            simulated.tick(10**8)


@pytest.mark.slow
@pytest.mark.parametrize(('is_busy', 'clock_name'), [(True, 'simulated'), (False, 'wall')])
def test_slow_answers_prevent_simulation_only_if_processors_are_free(
    monkeypatch, is_busy, clock_name
):
    monkeypatch.setattr(barriers, 'SLOWEST_MEDIAN_SEC', 0.0)
    share = 2.0 if is_busy else 0.0
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: share * time.monotonic())
    monkeypatch.setattr(pressure, 'idle_sec', time.monotonic)
    with running('five_hz'):
        assert topic(TOPIC).record().clock == clock_name


@pytest.mark.parametrize(
    ('answers_after_sec', 'stalled_share', 'in_time'),
    [(0.4, 0.0, True), (1.0, 0.0, False), (1.0, 0.75, True), (3.0, 1.0, False)],
)
def test_a_busy_machine_extends_the_time_to_answer_up_to_a_limit(
    monkeypatch, answers_after_sec, stalled_share, in_time
):
    now = [0.0]

    def spin_until(done, *, timeout_sec):
        now[0] += timeout_sec
        return done()

    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: stalled_share * now[0])
    monkeypatch.setattr(pressure, 'idle_sec', lambda: now[0])
    watcher = Watcher()
    monkeypatch.setattr(watcher, 'spin_until', spin_until)
    is_done = watcher.spin_until_free(lambda: now[0] >= answers_after_sec, free_sec=0.5)
    assert is_done == in_time


@pytest.mark.parametrize(
    ('in_room', 'stalled_share', 'after_sec', 'is_left'),
    [
        (False, 1.0, 16.0, False),
        (True, 0.0, 16.0, False),
        (True, 0.9, 40.0, True),
        (True, 1.0, 46.0, False),
    ],
)
def test_the_time_for_simulation_is_extended_on_a_busy_machine_when_grading(
    monkeypatch, in_room, stalled_share, after_sec, is_left
):
    now = [0.0]
    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: stalled_share * now[0])
    monkeypatch.setattr(pressure, 'idle_sec', lambda: now[0])
    monkeypatch.setattr(clock_budget, 'BUDGET_SEC', 15.0)
    monkeypatch.setattr(clock_budget, 'is_in_test_room', lambda: in_room)
    budget = clock_budget.ClockBudget()
    now[0] = after_sec
    assert budget.is_used(1.0) != is_left


class Tired(Node):
    """Publishes five times a second, and from some message on works for longer after it."""

    def __init__(self, *, rests, works_sec, **kwargs):
        super().__init__('tired', **kwargs)
        self.publisher = self.create_publisher(Empty, '/tired', 10)
        self.rests, self.works_sec = rests, works_sec
        self.create_timer(0.2, self.publish)

    def publish(self):
        self.publisher.publish(Empty())
        self.rests -= 1
        if self.rests < 0:
            time.sleep(self.works_sec)


def look_at_tired(**options):
    def make(context):
        return Tired(context=context, **options)

    with spinning(make), Watcher() as watcher:
        recorder = topic('/tired').listen(watcher)
        return sampling.record_simulated(watcher, recorder, seconds=10.0, step_sec=0.1)


@pytest.mark.slow
@pytest.mark.parametrize('rests', [0, 15])
def test_a_callback_longer_than_its_period_is_detected_early_or_late(monkeypatch, rests):
    # due messages are awaited, and not asked about
    monkeypatch.setattr(barriers, 'PROMPT_SEC', 5.0)
    assert str(look_at_tired(rests=rests, works_sec=0.25)) == driven_topic.OVERRUNS


def test_a_callback_may_take_as_long_as_until_the_next_one():
    # five messages at once, and a machine that delayed them
    expect_keeps_up({7: 5}, took_sec=0.3)
    for messages, took_sec in [({7: 5}, 1.0), ({3: 1, 8: 1, 13: 1, 18: 1}, 0.3)]:
        with pytest.raises(clock.Inconclusive, match=driven_topic.OVERRUNS):
            expect_keeps_up(messages, took_sec=took_sec)


def expect_keeps_up(messages, *, took_sec):
    """Expect it of 20 ticks of 40 ms, of which some had messages, and took so long."""
    topic = object.__new__(driven_topic.DrivenTopic)
    topic._ticks = [
        driven_topic._Tick(took_sec if tick in messages else 0.001, messages.get(tick, 0), False)
        for tick in range(20)
    ]
    topic.expect_keeps_up(20, step_ns=40_000_000)


def test_a_callback_that_works_a_little_after_its_message_is_not_too_slow(monkeypatch):
    """Only ticks without a due message are acknowledged, and these wait for the callback."""
    monkeypatch.setattr(barriers, 'SLOWEST_MEDIAN_SEC', SLOWEST_MEDIAN_SEC)
    assert look_at_tired(rests=0, works_sec=0.03).rate_hz == pytest.approx(5.0)


@pytest.mark.parametrize('nodes', [1, 2])
def test_ticks_with_a_due_message_are_not_acknowledged_for_a_sole_node(monkeypatch, nodes):
    came = []
    wait_for = barriers.Barriers.wait_for

    def counted(self, until):
        came.append(wait_for(self, until))
        return came[-1]

    # on a busy machine a message is late, and ticks take long
    monkeypatch.setattr(barriers, 'PROMPT_SEC', 5.0)
    monkeypatch.setattr(due_ticks, 'QUICK_PART', 100.0)
    monkeypatch.setattr(driven_topic, 'QUICK_PART', 100.0)
    monkeypatch.setattr(barriers.Barriers, 'wait_for', counted)
    with contextlib.ExitStack() as stack:
        if nodes > 1:
            stack.enter_context(spinning(lambda context: Node('other', context=context)))
        stack.enter_context(running('five_hz'))
        recording = topic(TOPIC).record(seconds=10.0)
    assert (recording.clock, len(recording.messages)) == ('simulated', 50)
    # nearly each of the 50 messages was due
    assert came.count(True) > 40 if nodes == 1 else not any(came)


def test_a_tick_is_acknowledged_if_its_due_message_does_not_come(monkeypatch):
    asked = []
    with (
        running('five_hz'),
        Watcher() as watcher,
        clock.SimulatedClock(watcher, needed={'/kinematics_publisher'}) as simulated,
    ):
        monkeypatch.setattr(simulated, 'acknowledge', lambda: asked.append(1))
        simulated.tick(10**8, until=lambda: True)
        assert not asked
        simulated.tick(10**8, until=lambda: False)
    assert asked


class Counter(Node):
    """Publishes twice a second, on every nth call of a timer; coarse steps skip calls."""

    def __init__(self, *, calls_each, **kwargs):
        super().__init__('counter', **kwargs)
        self.publisher = self.create_publisher(Empty, '/counted', 10)
        self.calls, self.calls_each = 0, calls_each
        self.create_timer(0.5 / calls_each, self.count)

    def count(self):
        self.calls += 1
        if self.calls % self.calls_each == 0:
            self.publisher.publish(Empty())


def look_at_counter(calls_each):
    def make(context):
        return Counter(calls_each=calls_each, context=context)

    with spinning(make), Watcher() as watcher:
        recorder = topic('/counted').listen(watcher)
        return sampling.record_simulated(watcher, recorder, seconds=10.0, step_sec=0.1)


@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_a_node_that_counts_calls_faster_than_the_steps_is_detected():
    assert str(look_at_counter(100)) == sampling.COUNTS


@pytest.mark.slow
@pytest.mark.usefixtures('patient')
def test_a_node_that_counts_timer_calls_is_measured_in_fine_steps():
    recording = look_at_counter(25)
    assert recording.clock == 'simulated'
    assert recording.rate_hz == pytest.approx(2.0, abs=0.02)
    assert len(recording.messages) >= 4


@pytest.mark.slow
def test_coarse_steps_prove_a_slow_period_in_little_time(monkeypatch):
    steps_ns = set()

    class Ticks(clock.SimulatedClock):
        def tick(self, step_ns, **options):
            steps_ns.add(step_ns)
            super().tick(step_ns, **options)

    monkeypatch.setattr(sampling, 'SimulatedClock', Ticks)
    with running('fifth_hz'):
        assert topic(TOPIC).record().clock == 'simulated'
    assert steps_ns == {10**8, 5 * 10**8}


@pytest.mark.slow
def test_a_recording_goes_on_until_it_has_enough_messages():
    with running('fifth_hz'):
        recording = topic(TOPIC).record(seconds=2.0)
    assert (recording.clock, len(recording.messages)) == ('simulated', 2)
    assert recording.seconds == pytest.approx(10.0, abs=0.11)
