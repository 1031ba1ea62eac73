"""How many submissions at a time the processors can take."""

import asyncio
import types

import pytest
from my_robot_basics.session import pressure

from grader.sandbox.limits import BUSY_SHARE, IDLE_SHARE
from grader.workers.adaptive_semaphore import LOOK_SEC, AdaptiveSemaphore


class Machine:
    """Submissions that pass a gate, while Linux reports the load that a test sets."""

    def __init__(self, monkeypatch, *, told_sec=1.0):
        self.now, self.stalled_sec = 0.0, told_sec
        clock = types.SimpleNamespace(monotonic=lambda: self.now)
        monkeypatch.setattr(pressure, 'time', clock)
        monkeypatch.setattr(pressure, 'stalled_sec', lambda: self.stalled_sec)
        self.gate = AdaptiveSemaphore(least=4, most=9, step=2)
        self.inside = []

    async def fill(self):
        """Let in as many submissions as possible; return how many are inside."""
        while True:
            waits = asyncio.ensure_future(self.gate.__aenter__())
            await asyncio.sleep(0)
            await asyncio.sleep(0)
            if not waits.done():
                waits.cancel()
                await asyncio.gather(waits, return_exceptions=True)
                return len(self.inside)
            self.inside.append(waits)

    async def after(self, seconds, *, share):
        """Let time pass and one submission end; return how many are inside afterwards."""
        self.now += seconds
        self.stalled_sec += share * seconds
        self.inside.pop()
        await self.gate.__aexit__()
        return await self.fill()

    async def after_each(self, *shares):
        return [await self.fill(), *[await self.after(LOOK_SEC, share=s) for s in shares]]


@pytest.mark.parametrize(
    ('shares', 'inside'),
    [
        ([0.1, 0.1, 0.1, 0.1], [4, 6, 8, 9, 9]),
        ([0.9, 0.9], [4, 4, 4]),
        # none is stopped: if five are too many, the next five that end are not replaced
        ([0.1, 0.1, 0.1, *[0.9] * 6], [4, 6, 8, 9, 8, 7, 6, 5, 4, 4]),
        ([0.1, *[(IDLE_SHARE + BUSY_SHARE) / 2] * 2], [4, 6, 6, 6]),
        ([0.1, 0.9, 0.1], [4, 6, 5, 6]),
    ],
)
def test_more_submissions_are_let_in_while_processors_are_idle(monkeypatch, shares, inside):
    assert asyncio.run(Machine(monkeypatch).after_each(*shares)) == inside


def test_the_number_of_submissions_changes_once_in_each_look_interval(monkeypatch):
    machine = Machine(monkeypatch)

    async def main():
        await machine.fill()
        return [await machine.after(LOOK_SEC / 4, share=0.0) for _ in range(8)]

    assert asyncio.run(main()) == [4, 4, 4, 6, 6, 6, 6, 8]


def test_the_initial_limit_stays_if_linux_reports_no_load(monkeypatch):
    machine = Machine(monkeypatch, told_sec=0.0)
    assert asyncio.run(machine.after_each(0.0, 0.0)) == [4, 4, 4]


def test_a_submission_that_fails_frees_its_place(monkeypatch):
    machine = Machine(monkeypatch)

    async def main():
        async with asyncio.timeout(10):
            for _ in range(5):
                with pytest.raises(OSError, match='no room'):
                    async with machine.gate:
                        raise OSError('no room')
        return await machine.fill()

    assert asyncio.run(main()) == 4
