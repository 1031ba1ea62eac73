"""Waiting in a lesson: until a condition is true, and never longer than the timeout."""

import threading

import nbformat
import pytest
from my_robot_basics.live import wait_until
from my_robot_basics.live.output import waiting
from my_robot_basics.session.errors import LiveError
from nbclient import NotebookClient

SLOW = """
from my_robot_basics.live import wait_until
import time
start = time.monotonic()
wait_until(lambda: time.monotonic() > start + {seconds}, timeout_sec={timeout_sec})
print('done')
"""


class Watching(NotebookClient):
    """Remembers what a display shows for a while."""

    def process_message(self, msg, cell, cell_index):
        if msg['msg_type'] in ('display_data', 'update_display_data'):
            self.__dict__.setdefault('shown', []).append(msg['content']['data'])
        return super().process_message(msg, cell, cell_index)


def run_cell(source):
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    client = Watching(notebook, timeout=60, allow_errors=True, kernel_name='python3')
    client.execute()
    return client.__dict__.get('shown', []), notebook.cells[0].outputs


def test_a_condition_that_is_not_a_function_is_refused_with_a_remedy():
    with pytest.raises(LiveError, match=r'saw \[\]: write wait_until\(lambda: …\)'):
        wait_until([])


def test_a_condition_that_is_already_true_is_checked_once():
    looked = []
    wait_until(lambda: looked.append(1) or True, timeout_sec=0.0)
    assert looked == [1]


def test_wait_until_returns_when_the_condition_becomes_true():
    event = threading.Event()
    timer = threading.Timer(0.2, event.set)
    timer.start()
    wait_until(event.is_set, timeout_sec=60.0)
    timer.join()
    assert event.is_set()


def test_wait_until_raises_a_short_readable_error_after_the_timeout():
    with pytest.raises(
        TimeoutError, match=r'waited 0\.05 s, .*: is the node still running'
    ) as info:
        wait_until(lambda: False, timeout_sec=0.05)
    assert isinstance(info.value, LiveError)


def test_an_exception_of_the_condition_is_raised():
    with pytest.raises(ZeroDivisionError):
        wait_until(lambda: 1 / 0)


@pytest.mark.starts
def test_a_long_wait_shows_its_progress_and_removes_it_at_the_end():
    shown, outputs = run_cell(SLOW.format(seconds=2.5, timeout_sec=30))
    texts = [data['text/plain'] for data in shown if data]
    assert texts[0] == 'waiting … 1 s of at most 30 s'
    assert len(texts) >= 2
    assert shown[0] == shown[-1] == {}
    kept = [output for output in outputs if output.get('data') != {}]
    assert [output['text'] for output in kept] == ['done\n']


def test_a_short_wait_shows_nothing(monkeypatch):
    monkeypatch.setattr(waiting.notebook, 'Display', None)
    monkeypatch.setattr(waiting, 'SILENT_SEC', 30.0)
    event = threading.Event()
    threading.Timer(0.05, event.set).start()
    wait_until(event.is_set, timeout_sec=60.0)


@pytest.mark.starts
def test_a_timeout_in_a_cell_takes_few_lines_and_removes_the_progress():
    shown, outputs = run_cell(SLOW.format(seconds=60, timeout_sec=1.2))
    assert shown[-1] == {}
    [error] = [output for output in outputs if output.output_type == 'error']
    assert error.ename == 'WaitTimeout'
    assert len('\n'.join(error.traceback).splitlines()) <= 3
