"""Which clock an arm follows, from its feedback while the robot's clock stands or moves."""

import time
from types import SimpleNamespace

import pytest
from my_robot_basics.checks.arm import followed_clocks
from my_robot_basics.checks.clock.robot_time import DrivenTime
from my_robot_basics.session import pressure


class Clock(DrivenTime):
    """A clock that brings some feedback while it stands still."""

    def __init__(self, told, comes):
        self.told, self.comes = told, comes

    def hold(self, done, *, free_sec, wall_sec):
        assert 0.0 < free_sec < wall_sec
        self.told += ['…'] * self.comes
        return done()


@pytest.mark.parametrize(
    ('is_slow', 'comes', 'follows'),
    [(True, 0, True), (True, 1, True), (True, 2, False), (False, 0, False)],
    ids=['stands still', 'was under way', 'goes on', 'is not slow'],
)
def test_a_slow_arm_that_pauses_with_the_clock_follows_it(monkeypatch, is_slow, comes, follows):
    told = ['…'] * 5
    monkeypatch.setattr(followed_clocks, 'is_under_way', lambda *_: is_slow)
    arm = SimpleNamespace(time=Clock(told, comes))
    sent = SimpleNamespace(feedback_count=lambda: len(told))
    assert followed_clocks._moves_with_clock(arm, sent, (1.0, -0.5)) == follows


@pytest.mark.parametrize(
    ('after_sec', 'stalled_share', 'is_done'),
    [(0.3, 0.0, True), (0.7, 0.0, False), (0.7, 1.0, True), (1.3, 1.0, False)],
)
def test_a_clock_is_held_longer_on_a_busy_machine(monkeypatch, after_sec, stalled_share, is_done):
    now = [0.0]
    clock = SimpleNamespace(hold=lambda seconds: now.__setitem__(0, now[0] + seconds), now_ns=0)
    monkeypatch.setattr(pressure, 'time', SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: stalled_share * now[0])
    monkeypatch.setattr(pressure, 'idle_sec', lambda: now[0])
    driven = DrivenTime(SimpleNamespace(), clock, step_ns=50_000_000, beat=lambda: 0)
    held = driven.hold(lambda: now[0] >= after_sec, **followed_clocks.HELD_SEC)
    assert held == is_done


@pytest.mark.parametrize(
    ('gone', 'moves_on'),
    [
        ([0.1, 0.2, 0.3, 0.4, 0.5], True),
        ([0.1, 0.2, 0.3, 0.4], False),
        ([0.0, 0.0, 0.4, 0.4, 0.4, 0.4], False),
        ([0.0] * 9, False),
        ([], False),
    ],
    ids=['at each step', 'too few', 'a late clock', 'stands still', 'says nothing'],
)
def test_an_arm_that_moves_while_its_clock_stands_still_uses_the_wall_clock(gone, moves_on):
    told = []

    def let_it_report(done, *, free_sec):
        assert not done()
        assert free_sec > 0.0
        told.extend((0, SimpleNamespace(position=[each, 0.0])) for each in gone)

    arm = SimpleNamespace(
        server=SimpleNamespace(watcher=SimpleNamespace(spin_until_free=let_it_report))
    )
    sent = SimpleNamespace(
        is_over=lambda: False, feedback=lambda: told, feedback_count=lambda: len(told)
    )
    assert followed_clocks._moves_on(arm, sent) == moves_on


class Stepped(DrivenTime):
    """A clock with whose every step a server adds a step of its own, of `adds_ns`."""

    def __init__(self, told, adds_ns):
        self.told, self.adds_ns, self.ns, self.step_ns = told, adds_ns, 0, 50_000_000

    def at_ns(self, wall_ns):
        return wall_ns

    def let_pass(self, done, *, seconds):
        position = 0.0
        for _ in range(round(seconds * 1e9 / self.step_ns)):
            self.ns += self.step_ns
            position += 0.2 * self.adds_ns / 1e9
            self.told.append((self.ns, SimpleNamespace(position=[position, 0.0])))


@pytest.mark.parametrize(
    ('adds_ns', 'keeps_up'),
    [(10_000_000, True), (12_500_000, True), (5_000_000, False), (0, False)],
)
def test_an_arm_gets_fine_steps_if_it_keeps_up_with_these(adds_ns, keeps_up):
    told = [(0, SimpleNamespace(position=[0.0, 0.0]))]
    sent = SimpleNamespace(
        is_over=lambda: False,
        feedback=lambda: told,
        feedback_count=lambda: len(told),
        goal=SimpleNamespace(speed=0.2),
    )
    driven = Stepped(told, adds_ns)
    assert followed_clocks._keeps_up_with_fine_steps(driven, sent) == keeps_up
    assert driven.step_ns == followed_clocks.FINE_NS


def test_an_arm_that_reports_next_to_nothing_gets_no_fine_steps():
    told = [(0, SimpleNamespace(position=[]))]
    sent = SimpleNamespace(
        is_over=lambda: False,
        feedback=lambda: told,
        feedback_count=lambda: len(told),
        goal=SimpleNamespace(speed=0.2),
    )
    driven = Stepped(told, 10_000_000)
    driven.let_pass = lambda *_, **__: None
    assert not followed_clocks._keeps_up_with_fine_steps(driven, sent)


@pytest.mark.parametrize(
    ('told_late', 'is_free'), [(True, False), (False, True)], ids=['after it', 'during it']
)
def test_an_answer_after_the_move_is_none_during_it(monkeypatch, told_late, is_free):
    """If the status with the end is lost at first, the answer seems to come during the move."""
    over_ns = []

    def end(*_, is_free):
        assert is_free
        over_ns.append(time.time_ns() + (-1 if told_late else 1) * 10**8)

    client = SimpleNamespace(
        service_is_ready=lambda: True, call_async=lambda _: SimpleNamespace(done=lambda: True)
    )
    watcher = SimpleNamespace(
        node=SimpleNamespace(create_client=lambda *_: client, destroy_client=lambda _: None),
        spin_until=lambda done, timeout_sec: done(),
        spin_until_free=lambda done, free_sec: done(),
    )
    sent = SimpleNamespace(is_over=lambda: bool(over_ns), over_ns=lambda: sum(over_ns))
    arm = SimpleNamespace(
        server=SimpleNamespace(watcher=watcher, node_name='/move_arm_server'),
        start=(0.0, 0.0),
        send=lambda goal: sent,
    )
    monkeypatch.setattr(followed_clocks, 'wait_for_probe', end)
    assert followed_clocks._answers_while_it_moves(arm) == is_free
