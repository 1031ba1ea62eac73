"""A forgotten `await` is named by every check that fails because of it, with its line."""

import warnings
from pathlib import Path

import pytest
from arm_checks import failures, rejects
from my_robot_basics.checks import CheckFailed, action, moves
from my_robot_basics.feedback import hidden
from my_robot_basics.live.nodes import unawaited
from nodes.running import imported

from arm_interfaces.action import MoveArm

MoveArmServer = imported('move_arm_server').MoveArmServer
STEP_SEC = imported('move_arm_server').STEP_SEC
NAMED = (
    'line {line} calls `sleep` without `await`, so nothing waits there (self.sleep(STEP_SEC)); '
    'write `await` in front of the call, and fix that first'
)


class ForgetsToAwait(MoveArmServer):
    """Adds a fixed step each time, and waits for none of them."""

    async def execute(self, handle):
        self.begin(handle)
        while self.part < 1.0 and not handle.is_cancel_requested:
            self.sleep(STEP_SEC)
            self.step(handle)
        return self.finish(handle)

    def step(self, handle):
        self.part = min(1.0, self.part + STEP_SEC / self.seconds) if self.seconds else 1.0
        self.position = self.on_the_way()
        self.report(handle)


class AcceptsAll(MoveArmServer):
    def is_possible(self, goal):
        return len(goal.position) == 2


@pytest.fixture
def watched():
    unawaited.watch()
    yield
    unawaited.watch()


@pytest.mark.filterwarnings('ignore:coroutine .* was never awaited')
def test_each_check_of_a_move_names_the_missing_await(run, watched):
    run(ForgetsToAwait)
    found = failures()
    assert sorted(found) == ['cancels', 'feedback', 'reaches', 'rejects']
    lines = [line.strip() for line in Path(__file__).read_text(encoding='utf-8').splitlines()]
    line = lines.index('self.sleep(STEP_SEC)') + 1
    named = NAMED.format(line=line)
    assert [text for text in found.values() if not text.endswith(f': {named}')] == []


def test_another_mistake_keeps_its_own_hint(run, watched):
    run(AcceptsAll)
    with pytest.raises(CheckFailed, match='reject a goal whose speed is not above 0'):
        rejects(action('/move_arm', MoveArm))


@pytest.mark.filterwarnings('ignore:coroutine .* was never awaited')
def test_the_hidden_part_quotes_nothing_of_the_students(run, watched, monkeypatch):
    details = []
    monkeypatch.setattr(hidden, 'tell_grader', details.append)
    run(ForgetsToAwait)
    hidden.start_cell(quiet=True)
    try:
        with pytest.raises(CheckFailed) as failed:
            moves.expect_feedback(action('/move_arm', MoveArm), (1.2, -0.6), speed=0.2)
    finally:
        hidden.start_cell(quiet=False)
    assert str(failed.value).startswith(hidden.PLACE)
    said = 'line … calls `…` without `await`, so nothing waits there (…)'
    assert said in str(failed.value)
    assert 'self.sleep(STEP_SEC)' in details[-1]


async def waits():
    """Do nothing."""


def test_the_first_one_is_noted_until_the_next_answer_and_python_still_warns(watched):
    with pytest.warns(RuntimeWarning, match="coroutine 'waits' was never awaited"):
        waits()
    name, number, line = unawaited.first()
    assert (name, line) == ('waits', 'waits()')
    assert Path(__file__).read_text(encoding='utf-8').splitlines()[number - 1].strip() == line
    unawaited.watch()
    assert unawaited.first()[0] == ''


@pytest.mark.filterwarnings('ignore:coroutine .* was never awaited')
def test_one_that_is_dropped_elsewhere_is_not_noted(watched):
    kept = [waits()]
    kept.clear()
    assert unawaited.first()[0] == ''


def test_python_tells_of_such_a_coroutine_in_the_way_that_is_noted():
    assert callable(warnings._warn_unawaited_coroutine)
