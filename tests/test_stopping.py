"""SIGTERM and SIGHUP end a command as Ctrl-C does."""

import signal

import pytest

from grader.__main__ import main
from grader.cli.stopping import stoppable
from grader.course import Course

SIGNALS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


@pytest.fixture(autouse=True)
def as_before():
    """Assert that a test leaves the handler of each signal as it was."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    assert {number: signal.getsignal(number) for number in SIGNALS} == before


@pytest.fixture
def status_after(monkeypatch, tmp_path):
    """Run a command that receives a signal to stop."""

    def run(number):
        monkeypatch.setattr(
            'grader.cli.begin_grade.find_submissions',
            lambda *_, **__: signal.raise_signal(number),
        )
        return main(['grade'], course=Course.at(tmp_path))

    return run


@pytest.mark.parametrize(('number', 'status'), SIGNALS.items())
def test_the_exit_status_shows_which_signal_ended_the_command(
    status_after, capsys, number, status
):
    assert status_after(number) == status
    assert 'course: stopped. What was finished is kept; run it again' in capsys.readouterr().err


def test_a_command_ends_with_the_status_of_sighup_if_its_terminal_is_gone(
    status_after, monkeypatch
):
    class Gone:
        def write(self, text):
            raise OSError(5, 'Input/output error')

    monkeypatch.setattr('sys.stderr', Gone())
    assert status_after(signal.SIGHUP) == 129


def test_a_handler_of_ctrl_c_handles_sigterm_and_sighup_too():
    answered = []
    former = signal.signal(signal.SIGINT, lambda number, frame: answered.append(number))
    try:
        with stoppable():
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGINT, former)
    assert answered == [signal.SIGTERM, signal.SIGHUP]


def test_sigterm_still_stops_a_command_with_sigint_ignored():
    former = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with pytest.raises(KeyboardInterrupt), stoppable():
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGINT, former)


def test_sighup_ignored_by_nohup_stays_ignored():
    former = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stoppable() as stop:
            signal.raise_signal(signal.SIGHUP)
        assert stop.status == 130
    finally:
        signal.signal(signal.SIGHUP, former)
