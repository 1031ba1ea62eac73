import time

import pytest
from dateutil.parser import parse
from hostile_papers import STOPS_DATEUTIL

from grader.common.dates import date_in, date_of, utc_of


@pytest.mark.parametrize(
    ('text', 'utc'),
    [
        ('2026-01-02 03:04:05.678900 UTC', '2026-01-02T03:04:05.678900+00:00'),
        ('2026-01-02 03:04:05.6789 UTC\r\n', '2026-01-02T03:04:05.678900+00:00'),
        ('2026-01-02 03:04:05', '2026-01-02T03:04:05+00:00'),
        ('2026-01-02T03:04:05Z', '2026-01-02T03:04:05+00:00'),
        ('2026-01-02 03:04', '2026-01-02T03:04:00+00:00'),
        ('2026-01-02', '2026-01-02T00:00:00+00:00'),
        ('2026-01-02 12:00:00 +0200', '2026-01-02T10:00:00+00:00'),
        ('2026-01-02 12:00:00 -05:30', '2026-01-02T17:30:00+00:00'),
        ('2026-01-02 12:00:00 CET', '2026-01-02T11:00:00+00:00'),
        ('2026-07-02 12:00:00 CEST', '2026-07-02T10:00:00+00:00'),
        ('2026-07-02 12:00:00 EDT', '2026-07-02T16:00:00+00:00'),
        ('2026-07-02 12:00:00 Europe/Berlin', '2026-07-02T10:00:00+00:00'),
    ],
)
def test_a_time_as_nbgrader_writes_it_is_read(text, utc):
    assert date_in(text).isoformat() == utc


@pytest.fixture
def clock_in(monkeypatch):
    """Set this machine's time zone."""

    def set_zone(name):
        monkeypatch.setenv('TZ', name)
        time.tzset()

    yield set_zone
    monkeypatch.undo()
    time.tzset()


@pytest.mark.parametrize(
    ('zone', 'text', 'utc'),
    [
        ('Asia/Shanghai', '2026-01-02 12:00:00 CST', '2026-01-02T04:00:00+00:00'),
        ('America/Chicago', '2026-01-02 12:00:00 CST', '2026-01-02T18:00:00+00:00'),
        ('America/Chicago', '2026-07-02 12:00:00 CDT', '2026-07-02T17:00:00+00:00'),
        ('UTC', '2026-01-02 12:00:00 CST', '2026-01-02T18:00:00+00:00'),
        ('Asia/Kolkata', '2026-01-02 12:00:00 IST', '2026-01-02T06:30:00+00:00'),
        ('Asia/Shanghai', '2026-01-02 12:00:00 UTC', '2026-01-02T12:00:00+00:00'),
        ('Asia/Shanghai', '2026-01-02 12:00:00 +0200', '2026-01-02T10:00:00+00:00'),
    ],
)
def test_an_ambiguous_zone_name_means_the_zone_of_this_machine(clock_in, zone, text, utc):
    """CST is the time of China, too: read as America's, each submission there would be late."""
    clock_in(zone)
    assert date_in(text).isoformat() == utc


@pytest.mark.parametrize(
    'text',
    [
        '',
        'soon',
        STOPS_DATEUTIL,
        '2026-13-45 10:00:00 UTC',
        '2026-01-02 25:00:00 UTC',
        '2026-01-02 10:00:00 Nowhere/Land',
        '2026-01-02 10:00:00 Europe',
        '2026-01-02 10:00:00 ../../etc/passwd',
        '2026-01-02 10:00:00 +9999',
        '0001-01-01 00:00:00 +2300',
        '٢٠٢٦-01-02 10:00:00 UTC',
        '2 January 2026',
        'today at 10',
        '1' * 100_000,
        '2026-01-02 10:00:00 ' + 'a' * 100_000,
    ],
)
def test_a_text_that_is_no_time_is_read_as_none(text):
    assert date_in(text) is None


def test_dateutil_still_raises_for_the_hostile_time():
    """If dateutil did not, the example of a hostile time would no longer test anything."""
    with pytest.raises(ArithmeticError):
        parse(STOPS_DATEUTIL)


def test_a_date_is_read_from_the_beginning_of_a_regular_file(tmp_path):
    path = tmp_path / 'timestamp.txt'
    assert date_of(path) is None
    path.write_bytes(b'\xff\xfe\x00')
    assert date_of(path) is None
    path.write_text('2026-01-02 03:04:05 UTC' + ' ' * 1_000_000)
    assert date_of(path).day == 2
    link = tmp_path / 'link'
    link.symlink_to(path)
    assert date_of(link) is None


def test_a_timestamp_outside_of_the_calendar_gives_none():
    assert utc_of(1_700_000_000).isoformat() == '2023-11-14T22:13:20+00:00'
    assert utc_of(1e12) is utc_of(-1e12) is utc_of(float('nan')) is None
