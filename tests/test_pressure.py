"""How busy the machine is."""

from grader import pressure


def test_what_linux_tells_is_read(monkeypatch, tmp_path):
    told = tmp_path / 'cpu'
    told.write_text(
        'some avg10=0.00 avg60=6.91 avg300=53.17 total=28759600458\n'
        'full avg10=0.00 avg60=0.00 avg300=0.00 total=0\n'
    )
    monkeypatch.setattr(pressure, 'CPU', told)
    assert pressure.crowded_sec() == 28759.600458


def test_a_linux_that_does_not_tell_counts_as_free(monkeypatch, tmp_path):
    monkeypatch.setattr(pressure, 'CPU', tmp_path / 'none')
    assert pressure.crowded_sec() == 0.0
