import io
import sys
import time

from grader.grade import HandedIn, Row
from grader.table import print_rows


class Terminal(io.StringIO):
    def isatty(self):
        return True


def slowly(names):
    for name in names:
        time.sleep(0.2)  # the bar is drawn ten times a second at most
        yield Row(name, '00_toy', None, 'no room')


def test_a_terminal_sees_how_many_are_done_how_fast_and_how_long_it_will_take(
    monkeypatch, tmp_path
):
    monkeypatch.setattr(sys, 'stderr', Terminal())
    names = ['ada', 'bob', 'eve', 'kim']
    submissions = [HandedIn(name, '00_toy', tmp_path) for name in names]
    list(print_rows(slowly(names), submissions))
    drawn = [line for line in sys.stderr.getvalue().split('\r') if '3/4' in line]
    assert drawn
    done, _, rate = drawn[-1].partition('[')[2].partition('<')
    assert done.startswith('00:')
    assert rate.startswith('00:')  # and not ?, as before the first one
    assert 'notebook/s' in rate


def test_a_log_sees_rows_alone(monkeypatch, tmp_path, capsys):
    list(print_rows(slowly(['ada']), [HandedIn('ada', '00_toy', tmp_path)]))
    printed = capsys.readouterr()
    assert printed.err == ''
    assert [line.split() for line in printed.out.splitlines()] == [
        ['student', 'assignment', 'score', 'reason'],
        ['ada', '00_toy', '–', 'no', 'room'],
    ]
