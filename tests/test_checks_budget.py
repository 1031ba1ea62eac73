"""How long Validate waits for the checks of an exercise, and what it says about the rest."""

import asyncio

import pytest
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.running import checks_budget
from my_robot_basics.validate.running.checks_budget import TOO_BUSY, TOO_SLOW, ChecksBudget
from my_robot_basics.validate.verdicts.overdue import judge_overdue
from nbformat.v4 import new_code_cell


class Watch:
    """Time that passes while a check runs."""

    wall = free = 0.0

    def __init__(self):
        self.began = Watch.wall, Watch.free

    def wall_sec(self):
        return Watch.wall - self.began[0]

    def free_sec(self):
        return Watch.free - self.began[1]


class Kernel:
    """Each check takes this time, and is given up as a kernel gives cells up."""

    def __init__(self, wall_sec, free_sec):
        self.takes, self.asked = (wall_sec, free_sec), 0

    async def run(self, source, *, timeout_sec, free_sec, on_input):
        self.asked += 1
        Watch.wall += self.takes[0]
        Watch.free += self.takes[1]
        is_cut = self.takes[0] >= timeout_sec or self.takes[1] >= free_sec
        return CellRun(timed_out=is_cut, cut_after_sec=self.takes[0] if is_cut else 0.0)


@pytest.fixture(autouse=True)
def watch(monkeypatch):
    monkeypatch.setattr(checks_budget, 'Stopwatch', Watch)
    monkeypatch.setattr(Watch, 'wall', 0.0)
    monkeypatch.setattr(Watch, 'free', 0.0)


def run(kernel, times):
    """Run this number of checks; return why each was given up, or ''."""
    budget = ChecksBudget()

    async def all_of_them():
        return [await budget.run(kernel, '', on_input=None) for _ in range(times)]

    return [each.given_up for each in asyncio.run(all_of_them())]


def test_checks_share_a_time_limit_and_none_starts_after_it():
    kernel = Kernel(9.0, 9.0)
    assert run(kernel, 5) == ['', '', TOO_SLOW, TOO_SLOW, TOO_SLOW]
    assert kernel.asked == 3


def test_a_busy_machine_gets_more_time_and_is_named_as_the_cause():
    assert run(Kernel(40.0, 2.0), 3) == ['', TOO_BUSY, TOO_BUSY]


def test_checks_that_end_in_time_are_judged():
    assert run(Kernel(2.0, 2.0), 4) == [''] * 4


def test_a_check_that_was_given_up_is_ungraded_with_a_reason():
    cell = new_code_cell(metadata={'nbgrader': {'grade_id': 'reaches', 'points': 2}})
    verdict = judge_overdue(cell, CellRun(timed_out=True, given_up=TOO_SLOW), [])
    assert (verdict.outcome, verdict.reason) == ('ungraded', TOO_SLOW)
