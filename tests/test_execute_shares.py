"""What the exercises of a notebook share: processors, time, and room for output."""

import asyncio

import pytest
from doubling_lesson import GOOD, handed_in, lesson
from fake_rooms import FakeRooms, ended
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.verdicts import budget
from nbformat.v4 import new_output

from grader.judging import execute as module
from grader.judging.execute import execute
from grader.sandbox.limits import MAX_RESULT_PARTS


@pytest.mark.parametrize(('notebooks', 'most'), [(1, 2), (2, 3), (3, 4)])
def test_exercises_run_side_by_side_unless_another_notebook_runs_already(
    monkeypatch, notebooks, most
):
    at_work, counts = [], []

    class Counting(FakeRooms):
        checks = []

        async def run_check(self, source):
            at_work.append(self)
            counts.append(len(at_work))
            await asyncio.sleep(0.1)
            at_work.remove(self)
            return ended()

    async def several():
        papers = [handed_in(lesson('a', 'b', 'c'), a=GOOD) for _ in range(notebooks)]
        return await asyncio.gather(*map(module.execute_exercises, papers))

    monkeypatch.setattr(module, 'GradingRooms', Counting)
    first, *_ = asyncio.run(several())
    # the first notebook began before the others, which run one exercise after the other
    assert max(counts) == most
    assert [each.grade_id for each in first.verdicts[:3]] == ['a-check', 'b-check', 'c-check']


def test_student_cells_share_one_budget(monkeypatch):
    given = []

    class Slow(FakeRooms):
        checks = [ended() for _ in range(3)]

        async def run_student_cell(self, source, *, timeout_sec):
            given.append(timeout_sec)
            await asyncio.sleep(min(timeout_sec, 0.2) if 'loop' in source else 0)
            return CellRun(status='ok')

    monkeypatch.setattr(module, 'GradingRooms', Slow)
    monkeypatch.setattr(module, 'Budget', lambda: budget.Budget(0.5))
    execute(handed_in(lesson('a', 'b', 'c'), a='loop', b='loop', c='loop'))
    assert given == sorted(given, reverse=True)
    assert max(given) <= 0.5
    assert min(given) >= 0.1  # a cell is never given no time at all


def test_a_notebook_keeps_limited_output_and_mentions_the_rest():
    space, cell = module._OutputSpace(2_000), [new_output('stream', text='x' * 400)]
    assert space.fit(cell) == space.fit(cell) == cell
    [output] = space.fit(cell)
    assert output.text.startswith('[not kept: all cells together printed more than 4,000,000')
    assert space.fit([]) == []


def test_only_some_of_many_small_outputs_are_kept():
    space, cell = module._OutputSpace(), [new_output('stream', text='x')] * 1_000
    kept = sum(len(space.fit(cell)) == 1_000 for _ in range(40))
    assert 0 < kept * len(cell) <= 8_000


def test_outputs_with_many_parts_are_kept_up_to_the_limit_of_a_result():
    space = module._OutputSpace()
    parts = new_output('display_data', {}, metadata={f'{n}': {} for n in range(10_000)})
    kept = sum(space.fit([parts]) == [parts] for _ in range(40))
    assert 0 < kept * 10_000 < MAX_RESULT_PARTS / 2
