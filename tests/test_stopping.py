"""What ends a process from outside ends it as Ctrl-C does."""

import signal

import pytest

from grader.__main__ import main
from grader.cli.stopping import stoppable
from grader.course import Course

SIGNALS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


@pytest.fixture(autouse=True)
def as_before():
    """Each signal is answered after a test as before it."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    assert {number: signal.getsignal(number) for number in SIGNALS} == before


@pytest.fixture
def told(monkeypatch, tmp_path):
    """Run a command that receives a signal to stop."""

    def run(number):
        monkeypatch.setattr(
            'grader.cli.begin_grade.find_submissions',
            lambda *_, **__: signal.raise_signal(number),
        )
        return main(['grade'], course=Course.at(tmp_path))

    return run


@pytest.mark.parametrize(('number', 'status'), SIGNALS.items())
def test_the_status_tells_by_which_signal(told, capsys, number, status):
    assert told(number) == status
    assert 'course: stopped. What was finished is kept; run it again' in capsys.readouterr().err


def test_a_terminal_that_is_gone_ends_it_no_otherwise(told, monkeypatch):
    class Gone:
        def write(self, text):
            raise OSError(5, 'Input/output error')

    monkeypatch.setattr('sys.stderr', Gone())
    assert told(signal.SIGHUP) == 129


def test_whoever_answers_ctrl_c_answers_all_of_them():
    answered = []
    former = signal.signal(signal.SIGINT, lambda number, frame: answered.append(number))
    try:
        with stoppable():
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGINT, former)
    assert answered == [signal.SIGTERM, signal.SIGHUP]


def test_ctrl_c_ignored_in_the_background_does_not_keep_others_out():
    former = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with pytest.raises(KeyboardInterrupt), stoppable():
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGINT, former)


def test_what_nohup_ignores_stays_ignored():
    former = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stoppable() as stop:
            signal.raise_signal(signal.SIGHUP)
        assert stop.status == 130
    finally:
        signal.signal(signal.SIGHUP, former)
