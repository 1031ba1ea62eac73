"""The kernels of *Validate*: forked from a process that has imported what they need."""

import asyncio
import subprocess
import sys

import pytest
from answered import answered
from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.forks import ForkServer
from my_robot_basics.validate.kernels.kernel import LocalKernel
from my_robot_basics.validate.running import run
from my_robot_basics.validate.verdicts.judging import JudgedExercise

NOTHING_SHARED = """
import importlib, threading
from my_robot_basics.validate.kernels import forkserver
for name in forkserver._IMPORTS:
    importlib.import_module(name)
from my_robot_basics.session import classroom
import zmq
print(classroom._domain_id, threading.active_count(), zmq.Context._instance)
"""
TELL = """
import os, random, sys, numpy
print([os.getcwd(), os.environ['FOO'], sys.argv[0], random.random(), numpy.random.random()])
"""


@pytest.fixture(scope='module')
def server():
    with ForkServer() as server:
        yield server


def in_kernels(server, tmp_path, use, number=1):
    """Return the results of using so many kernels, one after the other."""

    async def one(name):
        kernel = LocalKernel(tmp_path / name, {'FOO': name}, server)
        try:
            await kernel.start()
            return await use(kernel)
        finally:
            await kernel.stop(politely=False)

    async def each():
        return [await one(f'kernel{i}') for i in range(number)]

    return asyncio.run(each())


def test_modules_imported_before_forking_start_no_domain_thread_or_zmq_context():
    command = [sys.executable, '-P', '-c', NOTHING_SHARED]
    told = subprocess.run(command, capture_output=True, text=True, check=True)
    assert told.stdout.split() == ['None', '1', 'None']


def test_each_kernel_has_its_own_folder_environment_and_random_numbers(server, tmp_path):
    async def tell(kernel):
        result = await kernel.run(TELL, timeout_sec=60.0)
        return eval(''.join(output.text for output in result.outputs))

    first, second = in_kernels(server, tmp_path, tell, 2)
    assert first[:2] == [str(tmp_path / 'kernel0' / 'work'), 'kernel0']
    assert second[:2] == [str(tmp_path / 'kernel1' / 'work'), 'kernel1']
    assert not {*first} & {*second} - {first[2]}


@pytest.mark.parametrize(
    ('code', 'is_cut'),
    [('while True: pass', True), ('import time; time.sleep(3)', False)],
    ids=['computes', 'sleeps'],
)
def test_code_that_computes_is_given_up_on_a_busy_machine_but_code_that_sleeps_is_not(
    server, tmp_path, monkeypatch, code, is_cut
):
    monkeypatch.setattr(Stopwatch, 'free_sec', lambda self: 0.0)

    async def go(kernel):
        return await kernel.run(code, timeout_sec=300.0, free_sec=0.5)

    (result,) = in_kernels(server, tmp_path, go)
    assert (result.cut_after_sec > 0) is is_cut
    assert result.ran_to_end is not is_cut
    assert not result.died


def test_an_ended_fork_server_is_reported_as_a_failure_of_the_rooms(tmp_path):
    async def nothing(kernel):
        pass

    with ForkServer() as server:
        server._process.kill()
        with pytest.raises(RoomFailure, match='the process that forks kernels has ended'):
            in_kernels(server, tmp_path, nothing)


def test_two_exercises_are_judged_at_a_time_and_reported_in_the_lessons_order(
    tmp_path, monkeypatch
):
    now, most = set(), []

    async def judge(notebook, exercise, open_rooms, budget):
        now.add(exercise.name)
        most.append(len(now))
        for _ in range(3):
            await asyncio.sleep(0)
        now.remove(exercise.name)
        return JudgedExercise({}, {})

    monkeypatch.setattr(run, 'judge_exercise', judge)
    told = asyncio.run(run.validate(answered('07_common_errors', tmp_path), None))
    assert [part.name for part in told.parts] == ['fix_topic_name', 'fix_units', 'fix_stamp']
    assert max(most) == 2
