"""How busy the machine is."""

import types

import pytest
from my_robot_basics.session import pressure

TOLD = (
    'some avg10=0.00 avg60=6.91 avg300=53.17 total=28759600458\n'
    'full avg10=0.00 avg60=0.00 avg300=0.00 total=0\n'
)


def test_the_stalled_time_that_linux_reports_is_read(monkeypatch, tmp_path):
    told = tmp_path / 'cpu'
    told.write_text(TOLD)
    monkeypatch.setattr(pressure, 'CPU', told)
    assert pressure.stalled_sec() == 28759.600458


def test_a_linux_without_a_pressure_file_counts_as_free(monkeypatch, tmp_path):
    monkeypatch.setattr(pressure, 'CPU', tmp_path / 'none')
    assert pressure.stalled_sec() == 0.0


@pytest.mark.parametrize(('share', 'free_sec'), [(0.0, 4.0), (0.75, 1.0), (1.5, 0.0)])
def test_free_time_excludes_the_stalled_share(monkeypatch, share, free_sec):
    now = [100.0]
    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: share * now[0])
    monkeypatch.setattr(pressure, 'idle_sec', lambda: 2 * now[0])
    watch = pressure.Stopwatch()
    now[0] += 4.0
    assert (watch.wall_sec(), watch.free_sec()) == (4.0, free_sec)


@pytest.mark.parametrize(('idle_share', 'free_sec'), [(0.0, 0.02), (0.25, 1.02), (1.9, 4.0)])
def test_free_time_is_at_most_the_idle_time_of_the_processors(monkeypatch, idle_share, free_sec):
    now = [100.0]
    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: 0.0)
    monkeypatch.setattr(pressure, 'idle_sec', lambda: idle_share * now[0])
    watch = pressure.Stopwatch()
    now[0] += 4.0
    assert watch.free_sec() == pytest.approx(free_sec)
    assert watch.is_busy() == (free_sec < 2.0)


@pytest.mark.parametrize(('share', 'turns'), [(0.0, 4), (0.5, 8), (0.95, 20), (1.0, 20)])
def test_free_turns_end_after_enough_free_time_or_five_times_as_long(monkeypatch, share, turns):
    now = [100.0]
    monkeypatch.setattr(pressure, 'time', types.SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: share * now[0])
    monkeypatch.setattr(pressure, 'idle_sec', lambda: 2 * now[0])
    count = 0
    for turn in pressure.free_turns(4.0):
        count += 1
        assert turn == count
        now[0] += 1.0
    assert count == turns


def test_the_idle_time_of_all_processors_is_read(monkeypatch, tmp_path):
    told = tmp_path / 'uptime'
    told.write_text('350735.47 234388.90\n')
    monkeypatch.setattr(pressure, 'UPTIME', told)
    assert pressure.idle_sec() == 234388.90


def test_a_linux_without_an_uptime_file_counts_as_idle(monkeypatch, tmp_path):
    monkeypatch.setattr(pressure, 'UPTIME', tmp_path / 'none')
    before_sec = pressure.idle_sec()
    watch = pressure.Stopwatch()
    while watch.wall_sec() < 0.1:
        pass
    assert pressure.idle_sec() - before_sec >= 0.1
