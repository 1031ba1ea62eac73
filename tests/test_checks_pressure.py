"""How busy the machine is."""

import types

import pytest
from my_robot_basics.session import pressure

TOLD = (
    'some avg10=0.00 avg60=6.91 avg300=53.17 total=28759600458\n'
    'full avg10=0.00 avg60=0.00 avg300=0.00 total=0\n'
)


def test_what_linux_tells_is_read(monkeypatch, tmp_path):
    told = tmp_path / 'cpu'
    told.write_text(TOLD)
    monkeypatch.setattr(pressure, 'CPU', told)
    assert pressure.stalled_sec() == 28759.600458


def test_a_linux_that_does_not_tell_counts_as_free(monkeypatch, tmp_path):
    monkeypatch.setattr(pressure, 'CPU', tmp_path / 'none')
    assert pressure.stalled_sec() == 0.0


@pytest.mark.parametrize(('share', 'free_sec'), [(0.0, 4.0), (0.75, 1.0), (1.5, 0.0)])
def test_only_time_that_was_free_counts(monkeypatch, share, free_sec):
    now = [100.0]
    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: share * now[0])
    watch = pressure.Stopwatch()
    now[0] += 4.0
    assert (watch.wall_sec(), watch.free_sec()) == (4.0, free_sec)
