"""One kernel: what a cell may do to it, and how it ends."""

import asyncio
import time

import pytest
from grading_kernels import IGNORES, opened_kernel, processes_of, text_of
from my_robot_basics.validate.kernels import timeouts


@pytest.fixture(scope='module')
def shared(loop):
    """A kernel for cells that do it no harm."""
    with opened_kernel(loop) as kernel:
        yield kernel


ENDS = {
    'prints': ('print(1); print(2)', True, '1\n2\n'),
    'ends with a value': ('1 + 1', True, ''),
    'raises': ('print(1); 1 / 0', False, '1\n'),
    'a syntax error': ('def f(:', False, ''),
    'stderr alone': ('import sys; print(1, file=sys.stderr)', True, '1\n'),
    # a thread of ipykernel reads it: output of the cell's very last moment may be lost
    'a line of C code': (
        "import os, time; os.write(1, b'from C\\n'); time.sleep(1)", True, 'from C\n'
    ),
    'nothing': ('', True, ''),
    'asks for input': ("input('name? ')", False, ''),
    'asks for a password': ("import getpass; getpass.getpass()", False, ''),
}  # fmt: skip


@pytest.mark.parametrize(('code', 'ran_to_end', 'text'), ENDS.values(), ids=ENDS)
def test_a_cell_ends_and_its_kernel_stays_alive(shared, run_cell, code, ran_to_end, text):
    result = run_cell(shared, code)
    assert result.ran_to_end is ran_to_end
    assert text_of(result) == text
    assert (result.timed_out, result.died) == (False, False)
    assert shared.alive


def test_input_fails_in_a_cell_unless_a_callback_answers(shared, run_cell):
    async def answer(prompt):
        return prompt.upper()

    result = run_cell(shared, "print(input('name? '), input('age? '))", on_input=answer)
    assert text_of(result) == 'NAME?  AGE? \n'
    assert run_cell(shared, "input('name? ')").error.ename == 'StdinNotImplementedError'


def test_a_stalled_grader_does_not_use_up_the_time_of_a_cell(shared, loop):
    async def stands_still_meanwhile():
        cell = asyncio.create_task(
            shared.run('import time; time.sleep(0.5); print(1)', timeout_sec=1.0)
        )
        await asyncio.sleep(0.1)
        time.sleep(2.0)
        return await cell

    result = loop.run(stands_still_meanwhile())
    assert (text_of(result), result.timed_out) == ('1\n', False)


def test_waiting_for_a_cell_asks_how_much_time_the_cell_has_used(shared, loop):
    asked = []
    loop.run(shared.run('1', timeout_sec=10.0, used_sec=lambda: asked.append('…')))
    assert asked


def test_a_failing_answer_to_input_raises_at_once(own_kernel, loop):
    async def answer(prompt):
        raise RuntimeError('no answer to ' + prompt)

    with pytest.raises(RuntimeError, match='no answer to name'):
        loop.run(own_kernel.run("input('name? ')", timeout_sec=600.0, on_input=answer))


def test_expressions_come_back_with_the_reply(shared, run_cell):
    result = run_cell(shared, '', expressions={'reply': "'a' * 3"})
    assert result.expressions['reply']['data']['text/plain'] == "'aaa'"


HOOKS = """
for when in 'pre_run_cell', 'post_run_cell':
    get_ipython().events.register(when, lambda *_: print('hook'))
"""


def test_no_hook_of_cells_runs_when_an_expression_is_asked_for(own_kernel, run_cell):
    run_cell(own_kernel, HOOKS)
    assert text_of(run_cell(own_kernel, '')) == 'hook\n'
    result = run_cell(own_kernel, '', expressions={'reply': '1 + 1'})
    assert (result.outputs, result.expressions['reply']['data']['text/plain']) == ([], '2')


def test_a_display_is_updated_from_a_later_cell(shared, run_cell):
    first = run_cell(shared, "h = display('old', display_id=True)")
    second = run_cell(shared, "h.update('new'); print('done')")
    assert [o.data['text/plain'] for o in first.outputs] == ["'new'"]
    assert text_of(second) == 'done\n'


def test_an_endless_cell_is_interrupted_and_later_cells_still_run(spare_kernel, run_cell):
    run_cell(spare_kernel, 'x = 5')
    result = run_cell(spare_kernel, 'while True: pass', timeout_sec=1.5)
    assert (result.timed_out, result.died, result.error.ename) == (
        True,
        False,
        'KeyboardInterrupt',
    )
    assert text_of(run_cell(spare_kernel, 'print(x)')) == '5\n'


def test_a_cell_that_ignores_the_interrupt_is_killed(own_kernel, run_cell):
    # it must have begun to ignore interrupts by then, on a busy machine too
    result = run_cell(own_kernel, IGNORES, timeout_sec=3.0)
    assert (result.timed_out, result.died, own_kernel.alive) == (True, True, False)
    assert processes_of(own_kernel) == []


SLOW_TO_END = """
import time
try:
    while True: time.sleep(0.1)
except KeyboardInterrupt:
    time.sleep(3.0)
"""


@pytest.mark.slow
@pytest.mark.parametrize(('is_busy', 'died'), [(False, True), (True, False)])
def test_a_busy_machine_gives_an_interrupted_cell_more_time(
    monkeypatch, spare_kernel, run_cell, is_busy, died
):
    stalled_sec = time.monotonic if is_busy else lambda: 0.0
    monkeypatch.setattr(timeouts.pressure, 'stalled_sec', stalled_sec)
    monkeypatch.setattr(timeouts.pressure, 'idle_sec', time.monotonic)
    result = run_cell(spare_kernel, SLOW_TO_END, timeout_sec=1.5)
    assert (result.timed_out, result.died) == (True, died)


def test_the_extra_time_of_a_busy_machine_is_limited(monkeypatch, own_kernel, run_cell):
    monkeypatch.setattr(timeouts.pressure, 'stalled_sec', time.monotonic)
    monkeypatch.setattr(timeouts, 'INTERRUPT_MOST_SEC', 1.0)
    assert run_cell(own_kernel, IGNORES, timeout_sec=3.0).died


FATAL = {
    '_exit': 'import os; print(1, flush=True); os._exit(0)',
    'SIGKILL': 'import os; os.kill(os.getpid(), 9)',
    'a crash': 'import ctypes; ctypes.string_at(0)',
    'SIGKILL to its group': 'import os; os.killpg(0, 9)',
}


@pytest.mark.parametrize('code', FATAL.values(), ids=FATAL)
def test_a_kernel_that_dies_is_noticed(spare_kernel, run_cell, code):
    result = run_cell(spare_kernel, code, timeout_sec=600.0)
    assert (result.died, result.timed_out, spare_kernel.alive) == (True, False, False)
    again = run_cell(spare_kernel, 'print(1)', timeout_sec=600.0)
    assert (again.died, again.ran_to_end, again.outputs) == (True, False, [])


def test_a_kernel_whose_cell_calls_exit_ends_without_doubt_about_the_cause(
    spare_kernel, loop, run_cell
):
    result = run_cell(spare_kernel, 'exit()')
    assert (result.leaves, result.died, spare_kernel.alive) == (True, True, False)
    assert loop.run(spare_kernel.ending()) is None


def test_an_error_counts_though_its_output_was_lost(own_kernel, run_cell):
    run_cell(own_kernel, 'get_ipython()._showtraceback = lambda *a: None')
    result = run_cell(own_kernel, '1 / 0')
    assert not result.ran_to_end
    assert [o.ename for o in result.outputs] == ['ZeroDivisionError']
