"""A failure that is not the answer's fault is tried again, and then left to a person."""

import asyncio
import time
from copy import deepcopy

import pytest
from doubling_lesson import CANARY, GOOD, cells_of, handed_in, lesson, outcomes
from fake_rooms import DEAD, LATE, FakeRooms, ended
from my_robot_basics.session import pressure
from my_robot_basics.validate.verdicts import second_look

from grader.common.errors import RoomFailure
from grader.judging import execute as module
from grader.judging.execute import execute
from grader.notebook.restore import KEY

FAILURES = {
    'the test kernel died twice': ([DEAD, DEAD], 'ungraded', 2),
    'the test kernel died once': ([DEAD, ended()], 'passed', 2),
    'the check did not end': ([LATE, LATE], 'ungraded', 2),
    'a defect of the check': ([ended(error='KeyError')] * 2, 'ungraded', 2),
    'rooms that did not open': ([RoomFailure('no room')] * 2, 'ungraded', 2),
    'rooms that opened at last': ([RoomFailure('no room'), ended()], 'passed', 2),
    'a failed check is no failure of ours': ([ended(error='CheckFailed')], 'failed', 1),
    'a failed assert is none either': ([ended(error='AssertionError')], 'failed', 1),
}


@pytest.mark.parametrize(('checks', 'outcome', 'opened'), FAILURES.values(), ids=FAILURES)
def test_the_graders_own_failure_is_tried_again_and_then_left_to_a_person(
    monkeypatch, checks, outcome, opened
):
    rooms = type('GradingRooms', (FakeRooms,), {'checks': list(checks)})
    monkeypatch.setattr(module, 'GradingRooms', rooms)
    execution = execute(handed_in(lesson('a'), a=GOOD))
    verdict = execution.verdicts[0]
    assert (verdict.outcome, rooms.opened) == (outcome, opened)
    cell = cells_of(execution)['a-check']
    assert cell.metadata[KEY].outcome == outcome
    if outcome == 'ungraded':
        assert verdict.score is None
        assert 'a person has to look at it' in cell.outputs[0].text
        assert CANARY not in str((cell.outputs, cell.metadata, verdict))
        assert 'assert x' not in str((cell.outputs, cell.metadata, verdict))


STARVED, DISTURBED = ended(error='Starved'), ended(error='Disturbed')
CHECK_FAILED = ended(error='CheckFailed')
DOUBTS = {
    'a busy machine, once': ([STARVED, ended()], True, 0.0, 'passed', 2),
    'a busy machine, twice': ([STARVED, STARVED], True, 0.0, 'ungraded', 2),
    'an idle machine': ([STARVED, STARVED], False, 0.0, 'failed', 2),
    'a machine that is busy in the checks alone': (
        [STARVED, STARVED], False, 0.0, 'ungraded', 2, True,
    ),
    'a failure at the second look': ([STARVED, CHECK_FAILED], True, 0.0, 'failed', 2),
    'who burns the time in the checks': ([STARVED, STARVED], False, 0.9, 'failed', 2, True),
    'one that goes on ending, on a busy machine': (
        [DISTURBED, DISTURBED], False, 0.0, 'failed', 2, True,
    ),
    'who burns the time itself': ([STARVED, STARVED], True, 0.9, 'failed', 2),
    'whom the clock kept busy': ([STARVED, ended()], True, 0.9, 'passed', 2),
    'a node that ended with its clock': ([DISTURBED, ended()], False, 0.0, 'passed', 2),
    'one that goes on ending': ([DISTURBED, DISTURBED], True, 0.0, 'failed', 2),
    'a busy machine after it': ([DISTURBED, STARVED], True, 0.0, 'ungraded', 2),
    'who ends and burns after it': ([DISTURBED, STARVED], True, 0.9, 'failed', 2),
}  # fmt: skip


@pytest.mark.parametrize('doubt', DOUBTS.values(), ids=DOUBTS)
def test_a_doubtful_failure_is_judged_twice_and_using_up_the_time_gains_nothing(
    monkeypatch, doubt
):
    checks, is_machine_busy, used_sec, outcome, opened, *in_checks = doubt
    monkeypatch.setattr(pressure.Stopwatch, 'is_busy', lambda watch: bool(in_checks))

    async def answer():
        return is_machine_busy

    monkeypatch.setattr(second_look, 'is_machine_busy', answer)
    rooms = type('GradingRooms', (FakeRooms,), {'checks': deepcopy(checks), 'used_sec': used_sec})
    monkeypatch.setattr(module, 'GradingRooms', rooms)
    execution = execute(handed_in(lesson('a'), a=GOOD))
    verdict = execution.verdicts[0]
    assert (verdict.outcome, rooms.opened) == (outcome, opened)
    if outcome == 'ungraded':
        assert verdict.score is None
        assert 'a person has to look at it: the machine was too busy' in verdict.reason


def test_a_machine_is_busy_only_if_processes_wait_while_no_answer_runs(monkeypatch):
    monkeypatch.setattr(second_look, 'BUSY_LOOK_SEC', 0.05)
    for share, crowd in [(0.0, False), (0.2, False), (0.9, True)]:
        monkeypatch.setattr(pressure, 'stalled_sec', lambda share=share: share * time.monotonic())
        monkeypatch.setattr(pressure, 'idle_sec', time.monotonic)
        assert asyncio.run(second_look.is_machine_busy()) is crowd


def test_a_failure_in_one_exercise_leaves_the_verdicts_of_other_exercises(monkeypatch):
    class DeadForOne(FakeRooms):
        checks = []

        async def run_check(self, source):
            return DEAD if 'double_a' in source else ended()

    monkeypatch.setattr(module, 'GradingRooms', DeadForOne)
    execution = execute(handed_in(lesson('a', 'b')))
    assert outcomes(execution) == {'a-check': 'ungraded', 'b-check': 'passed', 'why': 'manual'}
