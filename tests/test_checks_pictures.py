"""The pictures of failing checks are PNGs, shown once, before the sentence."""

import pytest
from IPython.core.interactiveshell import InteractiveShell
from made_recordings import every, joint_state, recording
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.recordings import pictures
from my_robot_basics.feedback import errors

PNG = b'\x89PNG\r\n\x1a\n'


@pytest.mark.parametrize('clock', ['simulated', 'wall'])
@pytest.mark.parametrize('hz', [None, 5.0])
@pytest.mark.parametrize('times', [every(0.2), every(1.0, 3), []])
def test_the_picture_of_arrivals_is_a_reproducible_png(clock, hz, times):
    picture = pictures.plot_arrivals(recording(times, clock=clock), hz=hz)
    assert picture.startswith(PNG)
    assert picture == pictures.plot_arrivals(recording(times, clock=clock), hz=hz)


@pytest.mark.parametrize(
    ('assertion', 'arguments'),
    [
        ('assert_rate', {'hz': 1.0}),
        ('assert_positions_rad', {'low': (-1.0, -1.0), 'high': (1.0, 1.0)}),
    ],
)
def test_one_picture_is_shown_with_the_failure_message(monkeypatch, assertion, arguments):
    shown = []
    monkeypatch.setattr(errors, 'show', lambda picture, *, alt: shown.append((picture, alt)))
    made = recording(message=lambda time: joint_state(time, position=[23.4, -40.0]))
    with pytest.raises(CheckFailed):
        getattr(made, assertion)(**arguments)
    [(picture, alt)] = shown
    assert picture.startswith(PNG)
    assert alt.startswith('Picture of what was seen: ')


def test_an_arm_with_more_joints_has_no_picture():
    assert pictures.draw_misread_arm([1.0, 2.0, 3.0]) is None


@pytest.mark.starts
def test_show_displays_only_in_a_notebook(monkeypatch, capsys):
    InteractiveShell.instance()
    errors.show(pictures.plot_arrivals(recording(), hz=5.0), alt='five')
    InteractiveShell.clear_instance()
    assert capsys.readouterr().out == 'five\n'
    errors.show(b'no notebook, no picture', alt='')
    assert capsys.readouterr().out == ''
