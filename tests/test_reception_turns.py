"""A student who submits many files, or often, neither delays nor hides the others."""

import shutil
import time
from datetime import UTC, datetime
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import TOY, answered, with_own_database
from quick_serve import RIGHT, arrivals, put_there, serve_here

from grader.serving import inbound as inbound_module
from grader.serving import intake, reception, steps
from grader.serving import rounds as rounds_module
from grader.serving import serve as serve_module
from grader.serving.inbound import Entry, new_entries
from grader.serving.queue import GRADED, GRADING, REFUSED, REPLACED, Arrival
from grader.serving.queue_file import open_queue, open_queue_to_read
from grader.serving.reception import take_in_new_entries
from grader.serving.rounds import Rounds
from grader.serving.state import ServingState
from grader.serving.status import SHOWN, status_lines, write_status_page


@pytest.fixture
def course(released, tmp_path):
    return with_own_database(released, tmp_path)


@pytest.fixture
def inbound(came_in):
    return came_in


def test_submissions_that_a_later_one_replaces_delay_no_other_student(
    course, inbound, at_once, monkeypatch
):
    """Storing many large submissions takes long, so others are graded in between."""
    monkeypatch.setattr(steps, 'BUDGET_SEC', 0.0)
    monkeypatch.setattr(reception, 'BUDGET_SEC', 60.0)  # all have come in before the first turn
    place, placed = steps.put_in_place, []

    def puts(course, arrival):
        placed.append((arrival.student_id, arrival.state))
        return place(course, arrival)

    monkeypatch.setattr(steps, 'put_in_place', puts)
    for number in range(5):
        folder = inbound / f'mallory+{TOY}+2026-01-01 10:00:0{number}.000000 UTC'
        folder.mkdir()
        notebook = answered(course, f'# {number}\n{RIGHT}')
        (folder / f'{TOY}.ipynb').write_text(nbformat.writes(notebook))
        time.sleep(0.02)  # Linux's clock tells them apart
    put_there(course, inbound, 'zoe')
    serve_here(course, inbound)
    assert [student for student, _ in placed].index('zoe') <= 3
    with open_queue_to_read(course.gradebook) as queue:
        found = [(each.student_id, each.state) for each in queue.find(GRADED, REPLACED)]
    assert sorted(found) == [
        ('mallory', GRADED),
        *[('mallory', REPLACED)] * 4,
        ('zoe', GRADED),
    ]
    assert len(list(course.folder('submitted_before', 'mallory', TOY).iterdir())) == 4


def entry(name, owner, changed=0):
    at = datetime.fromtimestamp(changed, UTC)
    return Entry(name, f'{name} as it is', at, is_whole=True, owner=owner)


@pytest.fixture
def serving(course, inbound):
    with open_queue(course.gradebook, inbound) as queue:
        grading = SimpleNamespace(backend=SimpleNamespace(capacity=1))
        yield ServingState(course, queue, grading, inbound, None, lambda line: None, exporter=None)


@pytest.fixture
def taken(monkeypatch):
    """Replace the folder and taking in by a list and a wait; return it and the names taken in."""
    there, names = [], []

    def new(folder, seen, rounds):
        return (each for each in there if each.key not in seen)

    def take(course, queue, inbound, entry):
        names.append(entry.name)
        time.sleep(0.01)
        return []

    monkeypatch.setattr(reception, 'new_entries', new)
    monkeypatch.setattr(reception, 'take_in', take)
    return there, names


def test_taking_in_pauses_after_each_entry_that_takes_long(serving, taken, monkeypatch):
    there, names = taken
    there += [entry('1', 'mallory'), entry('2', 'mallory')]
    monkeypatch.setattr(reception, 'BUDGET_SEC', 0.0)
    assert [take_in_new_entries(serving), len(names)] == [True, 1]
    assert [take_in_new_entries(serving), len(names)] == [True, 2]
    assert not take_in_new_entries(serving)


def test_many_entries_that_take_a_short_time_are_taken_in_at_once(serving, taken, monkeypatch):
    there, names = taken
    there += [entry('1', 'ada'), entry('2', 'bob'), entry('3', 'zoe')]
    monkeypatch.setattr(reception, 'BUDGET_SEC', 60.0)
    assert take_in_new_entries(serving)
    assert names == ['1', '2', '3']


def test_a_student_with_many_entries_waits_for_students_with_one(serving, taken, monkeypatch):
    there, names = taken
    monkeypatch.setattr(reception, 'BUDGET_SEC', 0.0)
    there += [entry(f'mallory {number}', 'mallory', number) for number in range(1, 5)]
    there += [entry('ada', 'ada', 10), entry('bob', 'bob', 11)]
    while take_in_new_entries(serving):
        pass
    assert names[:3] == ['mallory 1', 'ada', 'bob']
    assert names[3:] == ['mallory 2', 'mallory 3', 'mallory 4']


def test_new_owners_do_not_delay_students_who_came_before_them(serving, taken, monkeypatch):
    """Where only its name decides who owns an entry, one student can pose as many owners."""
    there, names = taken
    monkeypatch.setattr(reception, 'BUDGET_SEC', 0.0)
    there.append(entry('ada 1', 'ada', 1))
    take_in_new_entries(serving)
    there.append(entry('ada 2', 'ada', time.time()))
    there += [entry(f'{n}', f'mallory{n}', time.time() + 1) for n in range(3)]
    take_in_new_entries(serving)
    assert names == ['ada 1', 'ada 2']


def test_a_student_with_many_files_does_not_keep_other_entries_from_being_seen(
    inbound, at_once, monkeypatch
):
    """Neither new nor known files delay others, and all of them are collected in the end."""
    monkeypatch.setattr(rounds_module, 'MOST_FILES_AT_ONCE', 30)
    for number in range(20):
        folder = inbound / f'eve+00_toy+{number:02}'
        folder.mkdir()
        for name in range(20):
            (folder / f'{name}.py').touch()
        (inbound / f'eve_{number:02}').mkdir()
    (inbound / 'zoe+00_toy+1').mkdir()
    rounds, seen, looked_at = Rounds(), {}, []
    tree = inbound_module._tree

    def counted(folder, name, status):
        for each in tree(folder, name, status):
            looked_at.append(name)
            yield each

    monkeypatch.setattr(inbound_module, '_tree', counted)
    found = [each.name for each in new_entries(inbound, seen, rounds)]
    assert 'zoe+00_toy+1' in found
    assert rounds.is_under_way
    for _ in range(60):
        looked_at.clear()
        seen |= {each.key: each.fingerprint for each in new_entries(inbound, seen, rounds)}
        assert len(looked_at) <= 30 + 21
    assert len(seen) == 41
    assert not list(new_entries(inbound, seen, rounds))
    assert not rounds.is_under_way


def test_an_older_refused_entry_is_still_listed_after_many_newer_ones(course, inbound, at_once):
    (inbound / 'honest_00_tyo.ipynb').write_text('{}')
    for number in range(SHOWN + 5):
        (inbound / f'mallory{number}_nothing.ipynb').write_text('{}')
    serve_here(course, inbound)
    (inbound / 'zoe_nothing.ipynb').write_text('{}')
    serve_here(course, inbound)
    with open_queue_to_read(course.gradebook) as queue:
        assert any('honest_00_tyo' in line for line in status_lines(course, queue))
        page = write_status_page(course, queue).read_text(encoding='utf-8')
    assert '7 more before these: ./course serve --status' in page


@pytest.mark.parametrize(('limit', 'most'), [('MOST_KEPT', 2), ('MOST_KEPT_BYTES', 50_000)])
def test_a_student_cannot_fill_the_disk_by_submitting_again_and_again(
    course, inbound, at_once, monkeypatch, limit, most
):
    """A refused submission stays where it was handed in, and uses up nobody else's limit."""
    monkeypatch.setattr(intake, limit, most)
    notebook = answered(course, RIGHT)
    for number in range(4):
        notebook.cells[-1].source = f'{number}' * 15_000
        (inbound / f'mallory_{TOY}.ipynb').write_text(nbformat.writes(notebook))
        serve_here(course, inbound)
    (inbound / f'zoe_{TOY}.ipynb').write_text(nbformat.writes(notebook))
    serve_here(course, inbound)
    found = arrivals(course)
    assert [each.student_id for each in found if each.state == GRADED][-1] == 'zoe'
    (refused,) = (each for each in found if each.state == REFUSED)
    assert 'submissions for 00_toy of mallory are kept, in ' in refused.reason
    assert f'nobody needs from gradebook/submitted_before/mallory/{TOY}' in refused.reason
    kept = course.folder('submitted_before', 'mallory', TOY)
    assert 1 <= len(list(kept.iterdir())) <= 2
    shutil.rmtree(kept)
    (inbound / f'mallory_{TOY}.ipynb').touch()
    serve_here(course, inbound)
    assert not [each for each in arrivals(course) if each.state == REFUSED]


def test_an_entry_that_is_refused_again_and_again_is_listed_once(course, inbound, at_once):
    for number in range(3):
        (inbound / 'mallory_nothing.ipynb').write_text('{}' + ' ' * number)
        serve_here(course, inbound)
    assert len(arrivals(course)) == 1


def test_a_submission_left_by_a_killed_process_is_not_shown_as_being_graded(course, inbound):
    with open_queue(course.gradebook, inbound) as queue:
        queue.add(f'zoe_{TOY}', '1', [Arrival(0, f'zoe_{TOY}', 1.0, GRADING, 'zoe', TOY)])
        said = list(status_lines(course, queue))
        assert './course serve FOLDER grades what has come in since' in said[0]
        assert 'Not graded to the end: the next ./course serve grades it' in said
        with serve_module.serving_lock(course):
            assert 'Being graded' in list(status_lines(course, queue))
