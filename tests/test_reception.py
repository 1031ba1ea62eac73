"""No entry of the inbound folder keeps the next one from being taken in, whatever is in it."""

import os
import shutil
import tarfile
import time
from contextlib import contextmanager

import nbformat
import pytest
import quick_serve
from course_maker import TOY, answered, with_own_database
from quick_serve import RIGHT, arrivals, put_there, serve_here
from sqlalchemy.exc import DataError, OperationalError

from grader.collect.archive_entries import MAX_PARTS
from grader.common.errors import GradebookError
from grader.common.text import printable
from grader.serving import inbound as inbound_module
from grader.serving import reception, results, steps
from grader.serving import rounds as rounds_module
from grader.serving import serve as serve_module
from grader.serving import state as state_module
from grader.serving.inbound import new_entries
from grader.serving.queue import FAILED, GRADED, REFUSED, Arrival
from grader.serving.queue_file import open_queue
from grader.serving.reception import take_in_new_entries
from grader.serving.state import ServingState
from grader.serving.status import write_status_page


@pytest.fixture
def course(released, tmp_path):
    return with_own_database(released, tmp_path)


@pytest.fixture
def inbound(came_in):
    return came_in


def refused(course):
    """Return why each entry was refused; assert that zoe's alone was graded."""
    found = arrivals(course)
    assert [each.student_id for each in found if each.state == GRADED] == ['zoe']
    return {each.entry: each.reason for each in found if each.state == REFUSED}


@contextmanager
def deep(folder, levels):
    """Nest folders so deeply that no path can name the deepest one."""
    folder.mkdir()
    here = os.open('.', os.O_RDONLY)
    try:
        os.chdir(folder)
        for _ in range(levels):
            os.mkdir('d')
            os.chdir('d')
        os.fchdir(here)
        yield
    finally:
        os.chdir(folder)
        for _ in range(levels):
            os.chdir('d')
        for _ in range(levels):
            os.chdir('..')
            shutil.rmtree('d')
        os.fchdir(here)
        os.close(here)


def test_a_file_beside_a_notebook_may_have_a_name_that_is_not_utf_8(course, inbound, at_once):
    folder = put_there(course, inbound, 'zoe')
    for name in (b'x\xff.txt', b'x\xff.py'):
        (folder / os.fsdecode(name)).touch()
    serve_here(course, inbound)
    assert refused(course) == {}


@pytest.mark.parametrize('name', [b'mallory\xff.zip', b'mallory\xff.ipynb', b'mallory\xff'])
def test_an_entry_with_a_name_that_is_not_utf_8_is_refused_under_an_escaped_name(
    course, inbound, at_once, name
):
    put_there(course, inbound, 'zoe')
    path = inbound / os.fsdecode(name)
    if path.suffix:
        path.write_text('{}')
    else:
        put_there(course, inbound, path.name)
    said = serve_here(course, inbound)
    stored = name.decode('utf-8', 'backslashreplace')
    ((entry, reason),) = refused(course).items()
    assert entry == stored
    assert reason
    assert any(line.startswith(f'not taken, look at it: {stored}: ') for line in said)
    assert stored in (course.gradebook / 'serve_status.html').read_text()
    assert serve_here(course, inbound) == []


def test_two_names_that_are_printed_alike_stay_two_entries(course, inbound, at_once):
    """Otherwise each would look like a changed version of the other, forever."""
    for name in (b'a\xff.ipynb', b'a\\xff.ipynb'):
        (inbound / os.fsdecode(name)).write_text('{}')
    assert len(serve_here(course, inbound)) == 2
    assert serve_here(course, inbound) == []
    assert len({each.entry for each in arrivals(course)}) == 2


def test_a_name_in_an_archive_that_is_not_utf_8_is_reported_escaped(course, inbound, at_once):
    put_there(course, inbound, 'zoe')
    member = tarfile.TarInfo(os.fsdecode(b'bob\xff_00_toy.ipynb'))
    with tarfile.open(inbound / f'mallory_{TOY}.tar', 'w') as box:
        box.addfile(member)
    serve_here(course, inbound)
    (reason,) = refused(course).values()
    assert reason.startswith('it is named after bob\\xff, and in the archive of mallory')


def test_a_folder_of_a_thousand_levels_is_refused_with_the_allowed_depth(course, inbound, at_once):
    put_there(course, inbound, 'zoe')
    with deep(inbound / 'mallory', 1_100):
        serve_here(course, inbound)
    assert refused(course) == {'mallory': f'it is more than {MAX_PARTS} folders deep'}


def test_a_change_at_the_deepest_allowed_level_changes_the_fingerprint(inbound, at_once):
    with deep(inbound / 'ada', MAX_PARTS - 1):
        deepest = inbound.joinpath('ada', *['d'] * (MAX_PARTS - 1))
        (deepest / 'a.ipynb').write_text('1')
        (before,) = new_entries(inbound, {})
        (deepest / 'a.ipynb').write_text('one more')
        (after,) = new_entries(inbound, {'ada': before.fingerprint})
    assert before.fingerprint != after.fingerprint


def test_an_unreadable_entry_is_reported_once_and_graded_when_it_can_be_read(
    course, inbound, at_once, monkeypatch
):
    put_there(course, inbound, 'zoe')
    for name in ('mallory+1', 'eve'):
        put_there(course, inbound, name)
    walk = inbound_module._tree

    def hard(folder, name, status):
        if name == 'mallory+1':
            raise OSError(24, 'Too many open files')
        if name == 'eve':
            raise RecursionError('maximum recursion depth exceeded')
        return walk(folder, name, status)

    with monkeypatch.context() as patch:
        patch.setattr(inbound_module, '_tree', hard)
        assert len(serve_here(course, inbound)) == 4
        assert refused(course) == {
            'mallory+1': 'it cannot be read: Too many open files',
            'eve': 'it cannot be read, because the grader failed: RecursionError: maximum '
            'recursion depth exceeded',
        }
        assert serve_here(course, inbound) == []
    serve_here(course, inbound)
    assert sorted(each.student_id for each in arrivals(course) if each.state == GRADED) == [
        'eve',
        'mallory+1',
        'zoe',
    ]
    assert len(arrivals(course)) == 3


def test_an_entry_that_vanishes_while_it_is_read_is_skipped(course, inbound, at_once, monkeypatch):
    put_there(course, inbound, 'eve')

    def gone(folder, name, status):
        raise FileNotFoundError(2, 'No such file or directory')

    monkeypatch.setattr(inbound_module, '_tree', gone)
    assert list(new_entries(inbound, {})) == []


def test_an_unexpected_error_in_one_entry_refuses_only_that_entry(
    course, inbound, at_once, monkeypatch, caplog
):
    put_there(course, inbound, 'zoe')
    put_there(course, inbound, 'mallory')
    take = reception.take_in

    def fails(course, queue, inbound, entry):
        if entry.name == 'mallory':
            raise UnicodeEncodeError('utf-8', '\udcff', 0, 1, 'surrogates not allowed')
        return take(course, queue, inbound, entry)

    monkeypatch.setattr(reception, 'take_in', fails)
    said = serve_here(course, inbound)
    (reason,) = refused(course).values()
    assert reason.startswith('the grader failed: UnicodeEncodeError: ')
    assert any(line.startswith('not taken, look at it: mallory: the grader') for line in said)
    assert 'Traceback' in caplog.text
    assert serve_here(course, inbound) == []


@pytest.mark.parametrize(
    'error', [GradebookError('it is locked'), OSError(28, 'No space left on device')]
)
def test_serving_ends_at_an_error_that_every_entry_would_meet(
    course, inbound, at_once, monkeypatch, error
):
    put_there(course, inbound, 'zoe')

    def fails(*_):
        raise error

    with monkeypatch.context() as patch:
        patch.setattr(reception, 'take_in', fails)
        with pytest.raises(type(error)):
            serve_here(course, inbound)
    assert serve_here(course, inbound)  # by the next process
    assert refused(course) == {}


MODULES = {
    '_prepared': state_module,
    'put_in_place': steps,
    'write_page': results,
    'release_page': results,
}
STEPS = {
    '_prepared': (KeyError('double'), FAILED, 'the grader failed: KeyError: '),
    'put_in_place': (KeyError('\x1b'), REFUSED, 'the grader failed: KeyError: '),
    'write_page': (KeyError('\x1b'), GRADED, 'no page can be made: the grader failed: Key'),
    'release_page': (OSError(5, 'I/O'), GRADED, 'no page can be made: the grader failed: OSE'),
}


@pytest.mark.parametrize('step', STEPS)
def test_an_unexpected_error_after_intake_affects_only_one_submission(
    course, inbound, at_once, monkeypatch, caplog, step
):
    error, state, reason = STEPS[step]
    for student in ('mallory', 'zoe'):
        put_there(course, inbound, student).joinpath('submission_secret.txt').write_text('aa')
    does, failed = getattr(MODULES[step], step), []

    def fails_once(*given, **named):
        if failed:
            return does(*given, **named)
        failed.append(given)
        raise error

    monkeypatch.setattr(MODULES[step], step, fails_once)
    monkeypatch.setattr(quick_serve, 'feedback_folder', lambda inbound: inbound.parent / 'pages')
    said = serve_here(course, inbound)
    found = {each.student_id: (each.state, each.reason) for each in arrivals(course)}
    assert found.pop('zoe') == (GRADED, '')
    ((its_state, its_reason),) = found.values()
    assert its_state == state
    assert its_reason.startswith(reason)
    assert any(printable(its_reason) in line for line in said)
    assert all(line == printable(line) for line in said)
    assert 'Traceback' in caplog.text
    assert serve_here(course, inbound) == []


@pytest.mark.parametrize('error', [DataError, OperationalError])
def test_a_submission_is_refused_for_bad_data_but_not_for_a_database_outage(
    course, inbound, at_once, monkeypatch, error
):
    """A refusal would leave students their former score, so their work waits for the database."""
    put_there(course, inbound, 'zoe')

    def fails(*_):
        raise error('SELECT 1', {}, Exception('the server is gone'))

    with monkeypatch.context() as patch:
        patch.setattr(steps, 'put_in_place', fails)
        if error is OperationalError:
            with pytest.raises(OperationalError):
                serve_here(course, inbound)
        else:
            serve_here(course, inbound)
    said = serve_here(course, inbound)
    states = [each.state for each in arrivals(course)]
    assert states == [GRADED if error is OperationalError else REFUSED]
    assert bool(said) == (error is OperationalError)


def test_the_next_process_keeps_replaced_submissions_that_were_not_yet_kept(
    course, inbound, at_once, monkeypatch
):
    for number in range(2):
        (inbound / f'zoe_{TOY}.ipynb').write_text(
            nbformat.writes(answered(course, f'# {number}\n{RIGHT}'))
        )
        with open_queue(course.gradebook, inbound) as queue:
            take_in_new_entries(
                ServingState(
                    course, queue, None, inbound, None, print, queue.seen(), exporter=None
                )
            )
        time.sleep(0.02)
    with monkeypatch.context() as patch:
        patch.setattr(serve_module, 'store_replaced', lambda serving: False)
        serve_here(course, inbound)
    assert not course.folder('submitted_before', 'zoe', TOY).exists()
    said = serve_here(course, inbound)
    assert [line.partition(':')[0] for line in said] == ['replaced']
    assert len(list(course.folder('submitted_before', 'zoe', TOY).iterdir())) == 1


@pytest.mark.parametrize('step', ['put_in_place', 'write_page'])
def test_a_full_disk_ends_serving_and_the_next_process_goes_on(
    course, inbound, at_once, monkeypatch, step
):
    put_there(course, inbound, 'zoe')

    def full(*_):
        raise OSError(28, 'No space left on device')

    with monkeypatch.context() as patch:
        patch.setattr(MODULES[step], step, full)
        with pytest.raises((OSError, GradebookError)):
            serve_here(course, inbound)
    assert serve_here(course, inbound)
    assert refused(course) == {}
    assert course.folder('feedback', 'zoe', TOY).exists()


def test_serving_once_ends_after_every_entry_was_looked_at(course, inbound, at_once, monkeypatch):
    monkeypatch.setattr(rounds_module, 'MOST_FILES_AT_ONCE', 1)
    for name in ('a', 'b', 'c'):
        (inbound / name).mkdir()
    assert serve_here(course, inbound) == []
    put_there(course, inbound, 'zoe')
    assert any('graded: 00_toy of zoe' in line for line in serve_here(course, inbound))


def test_the_owner_of_an_entry_is_its_linux_user_or_else_comes_from_its_name(inbound, at_once):
    for name in ('ada+00_toy+2026+x1', 'ada_00_toy.ipynb', 'bob', 'Zoe Z_8001_assignsubmission'):
        (inbound / name).touch()
    if os.geteuid() == 0:
        (inbound / 'eve+00_toy').touch()
        os.chown(inbound / 'eve+00_toy', 4_001, 4_001)
    owners = {each.name: each.owner for each in new_entries(inbound, {})}
    assert owners['ada+00_toy+2026+x1'] == owners['ada_00_toy.ipynb'] == 'ada'
    assert (owners['bob'], owners['Zoe Z_8001_assignsubmission']) == ('bob', 'Zoe Z')
    assert os.geteuid() or owners['eve+00_toy'] == 'user 4001'


def test_a_status_page_is_written_for_a_reason_with_lone_surrogates(course, inbound):
    with open_queue(course.gradebook, inbound) as queue:
        stored = queue.add('a', 'b', [Arrival(0, 'a', 0.0, REFUSED, reason='x\udcff \ud800')])
        write_status_page(course, queue)
        queue.update(*stored)
        assert [each.reason for each in queue.find(REFUSED)] == ['x\\xff \\ud800']
