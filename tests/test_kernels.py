"""One kernel: what a cell may do to it, and what is left when it has gone."""

import asyncio
import json
import os
import re
import tempfile
import time
from pathlib import Path

import psutil
import pytest
import zmq
from jupyter_client.kernelspec import KernelSpec
from my_robot_basics.validate import timeouts
from my_robot_basics.validate.limits import (
    FLOOD_CHARACTERS,
    MAX_MESSAGE_BYTES,
    MAX_MESSAGES_WAITING,
)
from my_robot_basics.validate.messages import next_message, unpacked
from my_robot_basics.validate.outputs import CUT_OFF, MAX_OUTPUT_CHARACTERS
from my_robot_basics.validate.questions import reply_of
from my_robot_basics.validate.verdict import judge
from nbformat.v4 import new_code_cell

from grader.common.errors import RoomFailure
from grader.kernels import kernels
from grader.kernels.kernel_manager import OurKernelSpec
from grader.kernels.kernels import GradingKernel

DOMAIN = 0
"""No kernel of this module makes a node."""


@pytest.fixture(scope='module')
def shared(loop):
    """A kernel for cells that do it no harm."""
    kernel = GradingKernel(room='student', domain_id=DOMAIN)
    loop.run(kernel.start())
    yield kernel
    loop.run(kernel.stop())


@pytest.fixture(scope='module')
def spares(loop):
    """The kernel that the last test has left, if one has."""
    spares = []
    yield spares
    for kernel in spares:
        loop.run(kernel.stop())


@pytest.fixture
def spare(loop, spares):
    """A kernel for a cell that leaves nothing in it: where it lives on, the next test has it."""
    kernel = spares.pop() if spares else GradingKernel(room='student', domain_id=DOMAIN)
    if not kernel.alive:
        loop.run(kernel.start())
    yield kernel
    if kernel.alive:
        spares.append(kernel)
    else:
        loop.run(kernel.stop())


@pytest.fixture
def own(loop):
    """A kernel of one test's own."""
    kernel = GradingKernel(room='student', domain_id=DOMAIN)
    loop.run(kernel.start())
    yield kernel
    loop.run(kernel.stop())


@pytest.fixture
def run(loop):
    def run(kernel, code, timeout_sec=60.0, **more):
        return loop.run(kernel.run(code, timeout_sec=timeout_sec, **more))

    return run


def text_of(cell_run):
    return ''.join(o.get('text', '') for o in cell_run.outputs)


def size_of(cell_run):
    return len(str(cell_run.outputs).replace('\\n', ' ').replace('\\x1b', ' '))


def processes_of(kernel):
    """Whatever runs with the kernel's own environment, the kernel itself included."""
    marker = str(kernel.folder)
    found = []
    for process in psutil.process_iter():
        try:
            if marker in process.environ().get('IPYTHONDIR', ''):
                found.append(process.pid)
        except psutil.Error:
            continue
    return found


ENDS = {
    'prints': ('print(1); print(2)', True, '1\n2\n'),
    'ends with a value': ('1 + 1', True, ''),
    'raises': ('print(1); 1 / 0', False, '1\n'),
    'a syntax error': ('def f(:', False, ''),
    'stderr alone': ('import sys; print(1, file=sys.stderr)', True, '1\n'),
    # a thread of ipykernel takes it over: what comes in the cell's very last moment may be lost
    'a line of C code': (
        "import os, time; os.write(1, b'from C\\n'); time.sleep(1)", True, 'from C\n'
    ),
    'nothing': ('', True, ''),
    'asks for input': ("input('name? ')", False, ''),
    'asks for a password': ("import getpass; getpass.getpass()", False, ''),
}  # fmt: skip


@pytest.mark.parametrize(('code', 'ran_to_end', 'text'), ENDS.values(), ids=ENDS)
def test_a_cell_comes_to_its_end(shared, run, code, ran_to_end, text):
    result = run(shared, code)
    assert result.ran_to_end is ran_to_end
    assert text_of(result) == text
    assert (result.timed_out, result.died) == (False, False)
    assert shared.alive


def test_a_question_is_answered_only_where_somebody_answers(shared, run):
    async def answer(prompt):
        return prompt.upper()

    result = run(shared, "print(input('name? '), input('age? '))", on_input=answer)
    assert text_of(result) == 'NAME?  AGE? \n'
    assert run(shared, "input('name? ')").error.ename == 'StdinNotImplementedError'


def test_a_cell_does_not_pay_for_a_grader_that_stood_still(shared, loop):
    async def stands_still_meanwhile():
        cell = asyncio.create_task(
            shared.run('import time; time.sleep(0.5); print(1)', timeout_sec=1.0)
        )
        await asyncio.sleep(0.1)
        time.sleep(2.0)
        return await cell

    result = loop.run(stands_still_meanwhile())
    assert (text_of(result), result.timed_out) == ('1\n', False)


def test_a_cell_is_waited_for_by_what_it_has_used(shared, loop):
    asked = []
    loop.run(shared.run('1', timeout_sec=10.0, used_sec=lambda: asked.append('…')))
    assert asked


def test_an_answer_that_fails_is_an_error_at_once(own, loop):
    async def answer(prompt):
        raise RuntimeError('no answer to ' + prompt)

    with pytest.raises(RuntimeError, match='no answer to name'):
        loop.run(own.run("input('name? ')", timeout_sec=600.0, on_input=answer))


def test_expressions_come_back_with_the_reply(shared, run):
    result = run(shared, '', expressions={'reply': "'a' * 3"})
    assert result.expressions['reply']['data']['text/plain'] == "'aaa'"


def test_a_display_is_updated_from_a_later_cell(shared, run):
    first = run(shared, "h = display('old', display_id=True)")
    second = run(shared, "h.update('new'); print('done')")
    assert [o.data['text/plain'] for o in first.outputs] == ["'new'"]
    assert text_of(second) == 'done\n'


def test_an_endless_cell_is_interrupted_and_costs_only_itself(spare, run):
    run(spare, 'x = 5')
    result = run(spare, 'while True: pass', timeout_sec=1.5)
    assert (result.timed_out, result.died, result.error.ename) == (
        True,
        False,
        'KeyboardInterrupt',
    )
    assert text_of(run(spare, 'print(x)')) == '5\n'


IGNORES = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
while True: time.sleep(1)
"""


def test_a_cell_that_ignores_the_interrupt_is_killed(own, run):
    # it must have begun to ignore interrupts by then, on a busy machine too
    result = run(own, IGNORES, timeout_sec=3.0)
    assert (result.timed_out, result.died, own.alive) == (True, True, False)
    assert processes_of(own) == []


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
    monkeypatch, spare, run, is_busy, died
):
    stalled_sec = time.monotonic if is_busy else lambda: 0.0
    monkeypatch.setattr(timeouts.pressure, 'stalled_sec', stalled_sec)
    monkeypatch.setattr(timeouts.pressure, 'idle_sec', time.monotonic)
    result = run(spare, SLOW_TO_END, timeout_sec=1.5)
    assert (result.timed_out, result.died) == (True, died)


def test_no_busy_machine_gives_more_than_its_limit(monkeypatch, own, run):
    monkeypatch.setattr(timeouts.pressure, 'stalled_sec', time.monotonic)
    monkeypatch.setattr(timeouts, 'INTERRUPT_MOST_SEC', 1.0)
    assert run(own, IGNORES, timeout_sec=3.0).died


FATAL = {
    '_exit': 'import os; print(1, flush=True); os._exit(0)',
    'SIGKILL': 'import os; os.kill(os.getpid(), 9)',
    'a crash': 'import ctypes; ctypes.string_at(0)',
    'SIGKILL to its group': 'import os; os.killpg(0, 9)',
}


@pytest.mark.parametrize('code', FATAL.values(), ids=FATAL)
def test_a_kernel_that_dies_is_noticed(spare, run, code):
    result = run(spare, code, timeout_sec=600.0)
    assert (result.died, result.timed_out, spare.alive) == (True, False, False)
    again = run(spare, 'print(1)', timeout_sec=600.0)
    assert (again.died, again.ran_to_end, again.outputs) == (True, False, [])


def test_a_kernel_whose_cell_calls_exit_ends_with_it_and_that_is_nobodys_doubt(spare, loop, run):
    result = run(spare, 'exit()')
    assert (result.leaves, result.died, spare.alive) == (True, True, False)
    assert loop.run(spare.ending()) is None


FLOODS = {
    'one huge text': "print('x' * 5_000_000)",
    'many lines': "for i in range(100_000): print(i)",
    'many displays': "for i in range(2_000): display(i)",
    'a message beyond all bounds': "print('x' * 40_000_000)",
    'from C': "import os\nfor i in range(500): os.write(1, b'x' * 10_000)",
}  # fmt: skip


@pytest.mark.parametrize('code', FLOODS.values(), ids=FLOODS)
def test_a_flood_is_drained_and_bounded_and_the_kernel_goes_on(spare, run, code):
    result = run(spare, code)
    assert not result.died
    assert size_of(result) < 1.1 * MAX_OUTPUT_CHARACTERS
    # ZMQ drops what a full queue has no room for, and that may be the first words after the flood
    after = [run(spare, 'print("after")') for _ in range(4)]
    assert all(each.ran_to_end for each in after)
    assert text_of(after[-1]) == 'after\n', [text_of(each) for each in after]


ENDLESS = {
    'displays': 'while True: display(1)',
    'prints': 'while True: print(1)',
    'forgeries': (
        'kernel = get_ipython().kernel\n'
        'while True: kernel.session.send(kernel.iopub_socket, "stream", {"text": 5})'
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize('code', ENDLESS.values(), ids=ENDLESS)
def test_an_endless_flood_does_not_keep_the_time_limit_waiting(spare, run, code):
    result = run(spare, code, timeout_sec=1.0)
    assert result.timed_out
    assert size_of(result) < 1.1 * MAX_OUTPUT_CHARACTERS


@pytest.mark.slow
def test_an_endless_flood_ends_long_before_the_time_limit(spare, run):
    code = "from IPython.display import HTML\nwhile True: display(HTML('<b>' * 10_000))"
    result = run(spare, code, timeout_sec=60.0)
    assert result.timed_out
    # up to its time limit it would print far more
    [dropped] = re.findall(r'\[([\d,]+) more characters of output were not kept', text_of(result))
    assert FLOOD_CHARACTERS < int(dropped.replace(',', '')) < 10 * FLOOD_CHARACTERS


OF_ANOTHER = """
import threading, time
kernel = get_ipython().kernel
def flood():
    while True:
        content, parent = {'name': 'stdout', 'text': 'x' * 8_000_000}, {'header': {'msg_id': 'x'}}
        kernel.session.send(kernel.iopub_socket, 'stream', content, parent=parent, ident=b'stream')
        time.sleep(0.02)
threading.Thread(target=flood, daemon=True).start()
"""


@pytest.mark.slow
def test_a_flood_for_another_cell_fills_no_memory_of_the_graders_and_counts(own, run, loop):
    assert run(own, OF_ANOTHER).ran_to_end
    before = psutil.Process().memory_info().rss
    loop.run(asyncio.sleep(4.0))
    assert psutil.Process().memory_info().rss - before < 100_000_000
    result = run(own, 'import time; time.sleep(50)')
    assert (result.flooded, result.timed_out) == (True, True)


@pytest.mark.parametrize('part', ['[],', '{},'])
def test_a_message_of_a_million_parts_is_passed_over(spare, run, part):
    forged = (
        'kernel = get_ipython().kernel\n'
        f'content = {{"data": [{part}] * 300_000}}\n'
        'parent = kernel.get_parent()\n'
        'kernel.session.send(kernel.iopub_socket, "display_data", content, parent=parent)\n'
        'print("after")'
    )
    result = run(spare, forged)
    assert result.ran_to_end
    assert text_of(result) == 'after\n'
    with pytest.raises(ValueError, match='300,001 objects and lists'):
        unpacked(f'[{part * 300_000}0]'.encode())


def test_the_limits_of_what_waits_are_those_of_the_sockets(spare):
    client = spare._connection.client
    for channel in (client.iopub_channel, client.shell_channel, client.stdin_channel):
        limits = [channel.socket.getsockopt(each) for each in (zmq.RCVHWM, zmq.MAXMSGSIZE)]
        assert limits == [MAX_MESSAGES_WAITING, MAX_MESSAGE_BYTES]


TOO_LARGE = {
    'printed': ("print('x' * 70_000_000)", None),
    'in an error': ("raise ValueError('x' * 70_000_000)", None),
    'as an answer': ('', {'reply': "'x' * 70_000_000"}),
}


@pytest.mark.slow
@pytest.mark.parametrize(('code', 'asked'), TOO_LARGE.values(), ids=TOO_LARGE)
def test_a_message_that_is_too_large_ends_the_kernel_and_it_is_said(spare, run, code, asked):
    """Else nothing that the kernel says would be received any more, and nobody told why."""
    result = run(spare, code, expressions=asked)
    assert (result.cut_off, result.flooded, result.died) == (True, True, True)
    reply = json.loads(reply_of(result, within_sec=10.0))
    assert reply == {'failed': f'no answer: your code {CUT_OFF}'}
    cell = new_code_cell('x', metadata={'nbgrader': {'grade_id': 'check', 'points': 1}})
    verdict = judge(cell, None, [('double', result)])
    assert verdict.outcome == 'failed'
    assert verdict.reason.endswith(f'before the check: your cell `double` {CUT_OFF}')
    assert 'sent over 64 MB at once' in CUT_OFF
    assert asyncio.run(spare.ending()) is None  # we have ended it: that is nobody's doubt


def test_a_kernel_that_ends_is_not_taken_for_one_that_was_cut_off(spare, run):
    result = run(spare, 'import os; os._exit(3)')
    assert (result.cut_off, result.timed_out, result.died) == (False, False, True)


def test_a_large_message_within_the_limit_cuts_nothing_off(spare, run):
    assert not run(spare, "print('x' * 9_000_000)").cut_off
    assert text_of(run(spare, "print('after')")) == 'after\n'


FORGE = """
kernel = get_ipython().kernel
parent, send, iopub = kernel.get_parent(), kernel.session.send, kernel.iopub_socket
for kind, content in [
    ('status', {}), ('status', b'[]'), ('stream', {'text': 5}), ('stream', b'"x"'),
    ('display_data', {'data': 7, 'transient': {'display_id': []}}), ('clear_output', b'3'),
    ('update_display_data', {}), ('update_display_data', b'5'), ('display_data', b'null'),
    ('error', {}), ('stream', b'not JSON'), ('stream', b'[' * 50_000), ('comm_msg', {}),
]:
    send(iopub, kind, content, parent=parent)
send(iopub, 'stream', {'name': 'stdout', 'text': 'x'}, parent={'msg_id': [1]})
iopub.send_multipart([b'stream', b'<IDS|MSG>', b'bad', b'{', b'}', b'[', b']'])
iopub.send_multipart([b'stream'])
iopub.send_multipart([b'', b'<IDS|MSG>'] + [b'[' * 50_000] * 5)
iopub.send_multipart([b'', b'<IDS|MSG>', b''] + [b'{}'] * 4)
print('done')
"""


def test_what_is_not_a_message_is_passed_over(spare, run):
    result = run(spare, FORGE)
    assert result.ran_to_end
    assert 'done\n' in text_of(result)


FORGED_END = """
kernel = get_ipython().kernel
kernel.session.send(
    kernel.iopub_socket, 'status', {'execution_state': 'idle'}, parent=kernel.get_parent()
)
while True: pass
"""


def test_a_forged_end_is_not_the_end(spare, run):
    result = run(spare, FORGED_END, timeout_sec=1.0)
    assert result.timed_out


def test_an_error_counts_though_its_output_was_lost(own, run):
    run(own, 'get_ipython()._showtraceback = lambda *a: None')
    result = run(own, '1 / 0')
    assert not result.ran_to_end
    assert [o.ename for o in result.outputs] == ['ZeroDivisionError']


CHILDREN = """
import os, subprocess
subprocess.Popen(['sleep', '1000'])
subprocess.Popen(['sleep', '1000'], start_new_session=True)
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0: os.execvp('sleep', ['sleep', '1000'])
    os._exit(0)
"""


@pytest.mark.parametrize('code', ['pass', IGNORES], ids=['ended', 'killed'])
def test_nothing_that_a_cell_started_outlives_the_kernel(own, loop, run, code):
    run(own, CHILDREN)
    deadline = time.monotonic() + 30
    # one that is about to become another program shows no environment for a moment
    while (count := len(processes_of(own))) != 4 and time.monotonic() < deadline:
        time.sleep(0.05)
    assert count == 4
    run(own, code, timeout_sec=0.5)
    loop.run(own.stop())
    assert processes_of(own) == []
    assert not own.folder.exists()


def test_a_thread_that_will_not_end_does_not_keep_a_kernel(own, loop, run):
    run(own, 'import threading, time\nthreading.Thread(target=time.sleep, args=(1000,)).start()')
    loop.run(own.stop())
    assert processes_of(own) == []


def test_a_kernel_leaves_no_file_and_no_descriptor(loop, run):
    before = None
    for _ in range(2):
        kernel = GradingKernel(room='test', domain_id=DOMAIN, seed='ab')
        loop.run(kernel.start())
        assert run(kernel, "open('left.txt', 'w').write('x')").ran_to_end
        loop.run(kernel.stop())
        loop.run(kernel.stop())  # twice does no harm
        assert not kernel.folder.exists()
        descriptors = len(os.listdir('/proc/self/fd'))
        before = before or descriptors
    assert descriptors <= before


def environment(run, kernel):
    result = run(kernel, "import os; print('\\n'.join(f'{k}={v}' for k, v in os.environ.items()))")
    return dict(line.split('=', 1) for line in text_of(result).splitlines() if '=' in line)


@pytest.mark.parametrize('room', ['student', 'test'])
def test_a_kernel_is_told_only_what_its_room_may_know(loop, run, monkeypatch, room):
    forbidden = {
        'PYTHONPATH': '/tmp/nowhere',
        'PYTEST_CURRENT_TEST': 'x',
        'MY_ROBOT_BASICS_SEED': 'secret1',
        'SECRET_TOKEN': 'secret2',
        'ROS_DOMAIN_ID': '77',
    }
    for name, value in forbidden.items():
        monkeypatch.setenv(name, value)
    kernel = GradingKernel(room=room, domain_id=5, seed='abcd')
    loop.run(kernel.start())
    try:
        seen = environment(run, kernel)
    finally:
        loop.run(kernel.stop())
    assert seen['MY_ROBOT_BASICS_ROOM'] == room
    assert seen['MY_ROBOT_BASICS_DOMAIN_ID'] == '5'
    assert seen.get('MY_ROBOT_BASICS_SEED') == {'test': 'abcd'}.get(room)
    assert not {'PYTHONPATH', 'PYTEST_CURRENT_TEST', 'SECRET_TOKEN', 'ROS_DOMAIN_ID'} & set(seen)
    assert not [v for v in seen.values() if 'secret' in v]


def test_a_kernel_works_in_an_empty_folder_and_imports_nothing_from_it(shared, run):
    code = "import os, sys; print(os.listdir(), {'', '.', os.getcwd()} & set(sys.path))"
    assert text_of(run(shared, code)) == '[] set()\n'


@pytest.mark.parametrize(
    ('argv', 'why'),
    [(['/bin/false'], 'its process ended'), (['/nowhere/python'], 'No such file')],
)
def test_a_kernel_that_does_not_start_is_the_graders_failure(loop, monkeypatch, argv, why):
    kernel = GradingKernel(room='test', domain_id=DOMAIN)
    spec = KernelSpec(argv=argv, language='python')
    monkeypatch.setattr(OurKernelSpec, 'get_kernel_spec', lambda self, name: spec)
    with pytest.raises(RoomFailure, match=f'the test kernel did not start: .*{why}'):
        loop.run(kernel.start())
    assert not kernel.folder.exists()


def test_a_kernel_that_never_answers_is_given_up(loop, monkeypatch):
    monkeypatch.setattr(kernels, 'START_TIMEOUT_SEC', 0.3)
    kernel = GradingKernel(room='test', domain_id=DOMAIN)
    spec = KernelSpec(argv=['sleep', '1000'], language='python')
    monkeypatch.setattr(OurKernelSpec, 'get_kernel_spec', lambda self, name: spec)
    with pytest.raises(RoomFailure, match='the test kernel did not start: TimeoutError'):
        loop.run(kernel.start())
    assert processes_of(kernel) == []


def test_cancelling_a_cell_leaves_a_kernel_that_can_be_stopped(own, loop):
    async def cancelled():
        task = asyncio.ensure_future(own.run('while True: pass', timeout_sec=600.0))
        await asyncio.sleep(0.3)
        task.cancel()
        await task

    with pytest.raises(asyncio.CancelledError):
        loop.run(cancelled())
    loop.run(own.stop())
    assert processes_of(own) == []


def test_a_long_path_for_temporary_files_is_not_used_for_sockets(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path / ('x' * 100)))
    kernel = GradingKernel(room='student', domain_id=DOMAIN)
    try:
        assert len(f'{kernel.paths.sockets}/zmq-10') < 107
    finally:
        asyncio.run(kernel.stop())
    assert not Path(kernel.folder).exists()


@pytest.mark.slow
@pytest.mark.timeout(60)
def test_messages_that_are_always_there_do_not_keep_the_loop(shared, loop):
    async def get(timeout):
        return {'parent_header': [], 'content': {}, 'msg_type': 'stream'}

    async def bounded():
        await asyncio.wait_for(next_message(get, 'request'), 0.2)

    with pytest.raises(TimeoutError):
        loop.run(bounded())
