"""A callback that sleeps is as late on a busy machine as on an idle one."""

from itertools import count
from types import SimpleNamespace

import pytest
from my_robot_basics.checks.nodes.logs import ANSWER_SEC
from my_robot_basics.checks.nodes.sleepers import PatientWait
from my_robot_basics.checks.recordings import sleeping_callbacks
from my_robot_basics.checks.recordings.sleeping_callbacks import awake_turns
from my_robot_basics.checks.relays.passage import Passage
from my_robot_basics.checks.relays.relays import LOST_SEC
from my_robot_basics.checks.relays.variety import VariedMessage
from my_robot_basics.checks.services.services import wait_for_all
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import pressure

SEC = 1_000_000_000
DEPTH = 10
FREE_PARTS = pytest.mark.parametrize('free_part', [1.0, 0.5, 0.3, 0.1])


class Machine:
    """A clock, and one node: it handles messages one after the other, each for `takes_sec`."""

    def __init__(self, takes_sec, *, free_part, sleeps):
        self.takes_sec, self.free_part, self.sleeps = takes_sec, free_part, sleeps
        self.now, self.done_at, self.queue, self.received = 0.0, 0.0, [], []

    def publish(self, message):
        self.handle()
        self.queue = [*self.queue[-DEPTH + 1 :], message]
        if len(self.queue) == 1:
            self.done_at = self.now + self.takes_sec

    def handle(self):
        while self.queue and self.done_at <= self.now:
            self.received.append((self.queue.pop(0), round(self.done_at * SEC)))
            self.done_at += self.takes_sec

    def publishers(self):
        return ('/relay',)

    def sleeps_on(self, name, seconds):
        self.handle()
        if not (self.sleeps and self.queue):
            return 0, ''
        woken = self.done_at
        self.now = min(woken, self.now + seconds)
        return (9, 'time.sleep(…)') if self.now < woken else (0, '')

    def spin_until(self, done, *, timeout_sec):
        end = self.now + timeout_sec
        while not done():
            if self.now >= end:
                return False
            self.now = min(end, self.now + 0.01)
            self.handle()
        return True

    def spin_for(self, seconds):
        self.spin_until(lambda: False, timeout_sec=seconds)

    def spin_until_free(self, done, *, free_sec):
        return Watcher.spin_until_free(self, done, free_sec=free_sec)


@pytest.fixture
def machine(monkeypatch):
    """A function: a Machine, whose clock is everybody's."""

    def make(takes_sec, *, free_part, sleeps=True):
        made = Machine(takes_sec, free_part=free_part, sleeps=sleeps)
        clock = SimpleNamespace(
            monotonic=lambda: made.now,
            time_ns=lambda: round(made.now * SEC),
            time=lambda: made.now,
        )
        for module in (pressure, sleeping_callbacks):
            monkeypatch.setattr(module, 'time', clock)
        monkeypatch.setattr(pressure, 'stalled_sec', lambda: (1.0 - free_part) * made.now)
        monkeypatch.setattr(pressure, 'idle_sec', lambda: made.now)
        monkeypatch.setattr(sleeping_callbacks.node_troubles, 'sleeps_on', made.sleeps_on)
        return made

    return make


def is_carried(node):
    """Whether what comes after the copies of a first message, which are still queued, is whole."""
    for _ in range(DEPTH):
        node.publish('first')
        node.spin_for(0.1)
    passage = Passage(
        node,
        node,
        publish=node.publish,
        what=lambda message: message,
        others_publish=False,
        earlier='first',
    )
    return passage.carry(VariedMessage(n, '') for n in count()).is_whole()


@FREE_PARTS
@pytest.mark.parametrize(('takes_sec', 'is_whole'), [(0.25, True), (0.5, True), (1.0, False)])
def test_a_relay_that_sleeps_gets_the_same_verdict_however_busy_the_machine_is(
    machine, takes_sec, is_whole, free_part
):
    assert is_carried(machine(takes_sec, free_part=free_part)) == is_whole


def test_a_relay_that_gets_no_processor_has_the_time_in_which_it_had_none(machine):
    assert is_carried(machine(1.0, free_part=0.1, sleeps=False))


@FREE_PARTS
@pytest.mark.parametrize(('takes_sec', 'is_out'), [(2.0, True), (5.0, False)])
def test_a_first_message_that_sleeps_has_the_same_limit_however_busy_the_machine_is(
    machine, takes_sec, is_out, free_part
):
    node = machine(takes_sec, free_part=free_part)
    node.publish('first')
    turns = awake_turns(LOST_SEC, node.publishers)
    assert is_out == any(
        node.spin_until(lambda: bool(node.received), timeout_sec=0.1) for _ in turns
    )


@FREE_PARTS
@pytest.mark.parametrize(('sleep_sec', 'is_in_time'), [(0.5, True), (1.0, False), (2.0, False)])
def test_a_sleep_for_each_of_seven_values_has_the_same_limit(
    machine, sleep_sec, is_in_time, free_part
):
    node = machine(sleep_sec, free_part=free_part)
    for number in range(7):
        node.publish(number)
    asked = SimpleNamespace(done=lambda: len(node.received) == 7)
    answered = wait_for_all(node, [asked], gives_up=str, names=['/relay'])
    assert answered == is_in_time


@FREE_PARTS
@pytest.mark.parametrize(('takes_sec', 'is_in_time'), [(2.0, True), (3.0, False), (5.0, False)])
def test_an_answer_in_the_log_has_the_same_limit_after_a_sleep(
    machine, takes_sec, is_in_time, free_part
):
    """A sleep of 3 s was in time if any process had to wait for a processor meanwhile."""
    node = machine(takes_sec, free_part=free_part)
    node.publish('target')
    wait = PatientWait(node, '/ik_solver_node')
    assert wait.until(lambda: bool(node.received), free_sec=ANSWER_SEC) == is_in_time
