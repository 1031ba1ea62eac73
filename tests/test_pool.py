import asyncio
import os
import signal
import threading

import pytest

from grader.common.pool import Pool


async def returned(value):
    return value


async def raised():
    raise OSError('no room')


def test_futures_return_results_and_raise_exceptions():
    with Pool(2) as pool:
        fine, broken = pool.submit(returned, 7), pool.submit(raised)
        assert fine.result() == 7
        with pytest.raises(OSError, match='no room'):
            broken.result()


@pytest.mark.parametrize('in_flight', [1, 3])
def test_a_pool_runs_at_most_the_given_number_of_tasks_at_a_time(in_flight):
    running, most = 0, 0

    async def work():
        nonlocal running, most
        running += 1
        most = max(most, running)
        await asyncio.sleep(0.01)
        running -= 1

    with Pool(in_flight) as pool:
        for future in [pool.submit(work) for _ in range(8)]:
            future.result()
    assert most == in_flight


def test_leaving_a_pool_cancels_all_tasks_and_lets_them_clean_up():
    begun, cleaned = threading.Event(), []

    async def work(name):
        begun.set()
        try:
            await asyncio.Event().wait()
        finally:
            await asyncio.sleep(0)
            cleaned.append(name)

    with Pool(1) as pool:
        runs, waits = pool.submit(work, 'runs'), pool.submit(work, 'waits')
        assert begun.wait(10)
    assert cleaned == ['runs']
    assert runs.cancelled()
    assert waits.cancelled()
    assert 'pool' not in {thread.name for thread in threading.enumerate()}


def test_ctrl_c_does_not_interrupt_the_cleanup_of_tasks(capsys):
    begun, cleaned = threading.Event(), []

    async def work():
        begun.set()
        try:
            await asyncio.Event().wait()
        finally:
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.sleep(0.1)
            cleaned.append(True)

    former = signal.getsignal(signal.SIGINT)
    with Pool(2) as pool:
        pool.submit(work)
        assert begun.wait(10)
    assert cleaned == [True]
    assert 'still ending what was running' in capsys.readouterr().err
    assert signal.getsignal(signal.SIGINT) is former


def test_a_pool_works_inside_a_running_event_loop():
    async def outer():
        with Pool(2) as pool:
            return pool.submit(returned, 'inner').result()

    assert asyncio.run(outer()) == 'inner'
