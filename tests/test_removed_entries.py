"""Entries of inbound folders are listed until they are gone, separately for each folder."""

import os
import sqlite3
import time
from contextlib import closing
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import TOY, answered, with_own_database
from quick_serve import RIGHT, arrivals, put_there, serve_here

from grader.serving import removed_entries
from grader.serving.queue import GRADED, REFUSED, REPLACED, Arrival
from grader.serving.queue_file import FILE, open_queue, open_queue_to_read
from grader.serving.removed_entries import RemovedEntries


@pytest.fixture
def course(released, tmp_path):
    return with_own_database(released, tmp_path)


@pytest.fixture
def inbound(came_in):
    return came_in


def test_a_refused_entry_is_listed_until_it_is_gone_and_again_when_it_returns(
    course, inbound, at_once
):
    refused = inbound / 'mallory_nothing.ipynb'
    refused.write_text('{}')
    (inbound / 'eve_nothing.ipynb').write_text('{}')
    serve_here(course, inbound)
    refused.rename(inbound.parent / refused.name)
    assert 'no longer there, so no longer listed: mallory_nothing.ipynb' in serve_here(
        course, inbound
    )
    assert [each.entry for each in arrivals(course)] == ['eve_nothing.ipynb']
    (inbound.parent / refused.name).rename(refused)
    serve_here(course, inbound)
    assert len(arrivals(course)) == 2


@pytest.fixture
def refused_here(course, inbound):
    """Finds entries that are gone, and records one that was refused, at least in part."""
    with open_queue(course.gradebook, inbound) as queue:
        seen = {}
        serving = SimpleNamespace(inbound=inbound, queue=queue, seen=seen, say=lambda line: None)

        def refused(name, *taken):
            (inbound / name).touch()
            rows = [Arrival(0, name, 1.0, GRADED, student, TOY) for student in taken]
            queue.add(name, '1', [*rows, Arrival(0, name, 1.0, REFUSED, reason='no work')])
            seen[name] = '1'

        yield RemovedEntries(serving), refused


def test_a_partly_graded_entry_is_still_known_after_it_vanishes(inbound, refused_here, course):
    """A network file system may show an empty folder for a moment."""
    removed, refused = refused_here
    refused('all.zip', 'zoe')
    refused('nothing.zip')
    for each in inbound.iterdir():
        each.unlink()
    assert removed.forget()
    assert [each.entry for each in arrivals(course)] == ['all.zip']
    with open_queue(course.gradebook, inbound) as queue:
        assert queue.seen() == {'all.zip': '1'}


def test_an_entry_that_vanishes_in_the_same_second_as_another_is_noticed(
    inbound, refused_here, monkeypatch
):
    """Some file systems count the time of a change in seconds."""
    monkeypatch.setattr(removed_entries, 'SETTLED_NS', 10**15)  # however long this test takes
    removed, refused = refused_here
    refused('one.zip')
    refused('other.zip')
    now = time.time_ns()
    for name in 'one.zip', 'other.zip':
        (inbound / name).unlink()
        os.utime(inbound, ns=(now, now))
        assert removed.forget()


def test_deleting_an_inbound_file_keeps_its_grade(course, inbound, at_once):
    (inbound / f'zoe_{TOY}.ipynb').write_text(nbformat.writes(answered(course, RIGHT)))
    serve_here(course, inbound)
    (inbound / f'zoe_{TOY}.ipynb').unlink()
    serve_here(course, inbound)
    assert [each.state for each in arrivals(course)] == [GRADED]


@pytest.fixture
def other(inbound):
    folder = inbound.with_name('came in elsewhere')
    folder.mkdir()
    return folder


def listed(course):
    return sorted(each.entry for each in arrivals(course))


def test_entries_of_one_folder_stay_listed_while_another_folder_is_served(
    course, inbound, other, at_once
):
    (inbound / 'of both.ipynb').write_text('{}')
    (inbound / 'of one.ipynb').write_text('{}')
    (other / 'of both.ipynb').write_text('{ }')
    serve_here(course, inbound)
    said = serve_here(course, other)
    assert [line.partition(': ')[0] for line in said] == ['not taken, look at it']
    (other / 'of both.ipynb').unlink()
    assert serve_here(course, other) == ['no longer there, so no longer listed: of both.ipynb']
    assert listed(course) == ['of both.ipynb', 'of one.ipynb']
    assert serve_here(course, inbound) == []


def test_two_folders_with_equal_entry_names_are_each_taken_in_once(
    course, inbound, other, at_once
):
    for folder in inbound, other, inbound, other:
        if not (folder / 'zoe').exists():
            put_there(course, folder, 'zoe')
        serve_here(course, folder)
    with open_queue_to_read(course.gradebook) as queue:
        assert len(queue.find(GRADED, REPLACED)) == 2


def test_entries_of_a_moved_folder_are_not_taken_in_again(course, inbound, other, at_once):
    put_there(course, inbound, 'zoe')
    for name in 'nothing.ipynb', 'gone.ipynb':
        (inbound / name).write_text('{}')
    serve_here(course, inbound)
    other.rmdir()
    inbound.rename(other)
    (other / 'gone.ipynb').unlink()
    assert serve_here(course, other) == ['no longer there, so no longer listed: gone.ipynb']
    assert listed(course) == ['nothing.ipynb', 'zoe']


def test_a_folder_mounted_under_two_paths_counts_as_one_folder(course, inbound, other):
    with open_queue(course.gradebook, inbound) as queue:
        queue.add('zoe', 'same files', [])
        queue.add('ada', 'before', [])
    with open_queue(course.gradebook, other) as queue:
        queue.add('ada', 'after', [])
        assert queue.seen() == {'zoe': 'same files', 'ada': 'after'}


def test_a_queue_file_of_an_older_version_without_folders_is_still_used(course, inbound, at_once):
    put_there(course, inbound, 'zoe')
    (inbound / 'nothing.ipynb').write_text('{}')
    serve_here(course, inbound)
    with closing(sqlite3.connect(course.gradebook / FILE)) as database, database:
        database.executescript("""
            CREATE TABLE seen (entry TEXT PRIMARY KEY, fingerprint TEXT NOT NULL);
            INSERT INTO seen SELECT entry, fingerprint FROM looked_into;
            DROP TABLE looked_into;
            ALTER TABLE arrivals DROP COLUMN inbound;
        """)
    assert listed(course) == ['nothing.ipynb', 'zoe']  # as ./course serve --status does
    (inbound / 'nothing.ipynb').unlink()
    assert serve_here(course, inbound) == ['no longer there, so no longer listed: nothing.ipynb']
    assert listed(course) == ['zoe']
