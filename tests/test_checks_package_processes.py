"""A node that is still on the graph when its program has ended: who is to blame for that."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import package_processes
from my_robot_basics.checks.package_processes import GONE_SEC, RunningExecutable
from my_robot_basics.feedback.errors import CheckFailed, Starved


@pytest.mark.parametrize(
    ('answers', 'free_sec', 'doubt'),
    [(True, GONE_SEC, CheckFailed), (False, GONE_SEC, Starved), (True, 1.0, Starved)],
    ids=['it lives', 'nobody answers', 'the machine is busy'],
)
def test_what_answers_no_more_may_be_a_name_alone(monkeypatch, answers, free_sec, doubt):
    watch = SimpleNamespace(free_sec=lambda: free_sec)
    monkeypatch.setattr(package_processes, 'Stopwatch', lambda: watch)
    monkeypatch.setattr(package_processes, 'answers_parameters', lambda *_: answers)
    program = RunningExecutable('greeter', 'greet', ())
    program._nodes = ['/greeter']
    program._watcher = SimpleNamespace(spin_until_free=lambda is_gone, free_sec: False)
    with pytest.raises(CheckFailed, match='/greeter to be gone from the graph') as raised:
        program._expect_gone()
    assert raised.type is doubt
