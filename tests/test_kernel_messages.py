"""Messages of a cell: floods, messages that are too large, and forged ones."""

import asyncio
import json
import re

import psutil
import pytest
import zmq
from grading_kernels import text_of
from my_robot_basics.validate.kernels.limits import (
    FLOOD_CHARACTERS,
    MAX_MESSAGE_BYTES,
    MAX_MESSAGES_WAITING,
)
from my_robot_basics.validate.kernels.messages import next_message, parse_message_part
from my_robot_basics.validate.kernels.outputs import CUT_OFF, MAX_OUTPUT_CHARACTERS
from my_robot_basics.validate.kernels.questions import reply_of
from my_robot_basics.validate.verdicts.verdict import judge
from nbformat.v4 import new_code_cell


def size_of(cell_run):
    return len(str(cell_run.outputs).replace('\\n', ' ').replace('\\x1b', ' '))


FLOODS = {
    'one huge text': "print('x' * 5_000_000)",
    'many lines': "for i in range(100_000): print(i)",
    'many displays': "for i in range(2_000): display(i)",
    'a message beyond all bounds': "print('x' * 40_000_000)",
    'from C': "import os\nfor i in range(500): os.write(1, b'x' * 10_000)",
}  # fmt: skip


@pytest.mark.parametrize('code', FLOODS.values(), ids=FLOODS)
def test_a_flood_is_drained_and_bounded_and_the_kernel_goes_on(spare_kernel, run_cell, code):
    result = run_cell(spare_kernel, code)
    assert not result.died
    assert size_of(result) < 1.1 * MAX_OUTPUT_CHARACTERS
    # ZMQ drops what a full queue has no room for, and that may be the first words after the flood
    after = [run_cell(spare_kernel, 'print("after")') for _ in range(4)]
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
def test_an_endless_flood_does_not_delay_the_time_limit(spare_kernel, run_cell, code):
    result = run_cell(spare_kernel, code, timeout_sec=1.0)
    assert result.timed_out
    assert size_of(result) < 1.1 * MAX_OUTPUT_CHARACTERS


@pytest.mark.slow
def test_an_endless_flood_ends_long_before_the_time_limit(spare_kernel, run_cell):
    code = "from IPython.display import HTML\nwhile True: display(HTML('<b>' * 10_000))"
    result = run_cell(spare_kernel, code, timeout_sec=60.0)
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
def test_a_flood_for_another_cell_fills_no_memory_and_counts_as_a_flood(
    own_kernel, run_cell, loop
):
    assert run_cell(own_kernel, OF_ANOTHER).ran_to_end
    before = psutil.Process().memory_info().rss
    loop.run(asyncio.sleep(4.0))
    assert psutil.Process().memory_info().rss - before < 100_000_000
    result = run_cell(own_kernel, 'import time; time.sleep(50)')
    assert (result.flooded, result.timed_out) == (True, True)


@pytest.mark.parametrize('part', ['[],', '{},'])
def test_a_message_of_too_many_parts_is_ignored(spare_kernel, run_cell, part):
    forged = (
        'kernel = get_ipython().kernel\n'
        f'content = {{"data": [{part}] * 300_000}}\n'
        'parent = kernel.get_parent()\n'
        'kernel.session.send(kernel.iopub_socket, "display_data", content, parent=parent)\n'
        'print("after")'
    )
    result = run_cell(spare_kernel, forged)
    assert result.ran_to_end
    assert text_of(result) == 'after\n'
    with pytest.raises(ValueError, match='300,001 objects and lists'):
        parse_message_part(f'[{part * 300_000}0]'.encode())


def test_each_socket_limits_waiting_messages_and_their_size(spare_kernel):
    client = spare_kernel._connection.client
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
def test_a_message_that_is_too_large_ends_the_kernel_and_is_reported(
    spare_kernel, run_cell, code, asked
):
    """Otherwise no more messages of the kernel would arrive, and nothing would say why."""
    result = run_cell(spare_kernel, code, expressions=asked)
    assert (result.cut_off, result.flooded, result.died) == (True, True, True)
    reply = json.loads(reply_of(result, within_sec=10.0))
    assert reply == {'failed': f'no answer: your code {CUT_OFF}'}
    cell = new_code_cell('x', metadata={'nbgrader': {'grade_id': 'check', 'points': 1}})
    verdict = judge(cell, None, [('double', result)])
    assert verdict.outcome == 'failed'
    assert verdict.reason.endswith(f'before the check: your cell `double` {CUT_OFF}')
    assert 'sent over 64 MB at once' in CUT_OFF
    assert asyncio.run(spare_kernel.ending()) is None  # the grader has ended it: no doubt


def test_a_kernel_that_ends_is_not_taken_for_one_that_was_cut_off(spare_kernel, run_cell):
    result = run_cell(spare_kernel, 'import os; os._exit(3)')
    assert (result.cut_off, result.timed_out, result.died) == (False, False, True)


def test_a_large_message_within_the_limit_cuts_nothing_off(spare_kernel, run_cell):
    assert not run_cell(spare_kernel, "print('x' * 9_000_000)").cut_off
    assert text_of(run_cell(spare_kernel, "print('after')")) == 'after\n'


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


def test_malformed_messages_are_ignored(spare_kernel, run_cell):
    result = run_cell(spare_kernel, FORGE)
    assert result.ran_to_end
    assert 'done\n' in text_of(result)


FORGED_END = """
kernel = get_ipython().kernel
kernel.session.send(
    kernel.iopub_socket, 'status', {'execution_state': 'idle'}, parent=kernel.get_parent()
)
while True: pass
"""


def test_a_forged_idle_status_does_not_end_a_cell(spare_kernel, run_cell):
    result = run_cell(spare_kernel, FORGED_END, timeout_sec=1.0)
    assert result.timed_out


@pytest.mark.slow
@pytest.mark.timeout(60)
def test_an_endless_queue_of_messages_does_not_block_the_event_loop(loop):
    async def get(timeout):
        return {'parent_header': [], 'content': {}, 'msg_type': 'stream'}

    async def bounded():
        await asyncio.wait_for(next_message(get, 'request'), 0.2)

    with pytest.raises(TimeoutError):
        loop.run(bounded())
