"""In a folder that students write to, the owner in Linux decides, not the name of a file."""

import os
import threading
import time
import zipfile
from contextlib import contextmanager
from datetime import UTC, datetime

import pytest

from grader.collect import live_folders
from grader.collect.live_folders import LiveFolder
from grader.collect.matching import match
from grader.collect.unpack_limits import UnpackLimits
from grader.collect.uploads import read_inbound_entry, read_upload
from grader.common.files import first_names
from grader.notebook.submission import SECRET, TIMESTAMP
from grader.serving import inbound as serving_inbound

ALICE, BOB = 4_001, 4_002
STRANGER = 4_003
LESSON = '03_publisher'
CLAIMED = '2020-01-01 00:00:00.000000 UTC'
LOGINS = {ALICE: 'alice', BOB: 'bob'}

needs_root = pytest.mark.skipif(os.geteuid() != 0, reason='only root gives files to others')


@pytest.fixture(autouse=True)
def users(monkeypatch):
    """Alice and Bob have names on this machine."""
    monkeypatch.setattr(live_folders, '_login', lambda uid: LOGINS.get(uid, ''))


@pytest.fixture
def inbound(tmp_path):
    folder = tmp_path / 'inbound'
    folder.mkdir()
    folder.chmod(0o733)
    return folder


def submit(inbound, student, uid, content='{}'):
    """Put a submission there as `nbgrader submit` does; return its folder."""
    folder = inbound / f'{student}+{LESSON}+{CLAIMED}+x1'
    folder.mkdir()
    for name, text in (
        (f'{LESSON}.ipynb', content),
        ('timestamp.txt', CLAIMED),
        ('submission_secret.txt', 'aa'),
    ):
        (folder / name).write_text(text)
        os.chown(folder / name, uid, uid)
    os.chown(folder, uid, uid)
    folder.chmod(0o777)
    return folder


def put(file, uid):
    """Write a file that belongs to a user and contains only the number of that user."""
    file.parent.mkdir(exist_ok=True, parents=True)
    file.write_text(str(uid))
    os.chown(file, uid, uid)


def collected(inbound, tmp_path):
    """Match the files; return the student of each by its content, and the reasons of refusals."""
    aside = tmp_path / 'aside'
    aside.mkdir(exist_ok=True)
    taken, left = match(list(read_upload(inbound, aside)), [LESSON])
    whose = {each.notebook.readable.read_text(): each.student_id for each in taken}
    others = [each for each in left if each.incoming.parts[-1] != TIMESTAMP]
    return whose, [each.reason for each in others if each.needs_attention]


@needs_root
def test_a_folder_named_after_another_student_than_its_owner_is_refused(inbound, tmp_path):
    submit(inbound, 'alice', ALICE, "alice's")
    submit(inbound, 'bob', ALICE, "alice's, as bob")
    whose, reasons = collected(inbound, tmp_path)
    assert whose == {"alice's": 'alice'}
    (reason,) = reasons
    assert reason.startswith('it is named after bob, and the user alice put it there')


@needs_root
def test_the_time_of_a_submission_is_its_change_time_not_a_time_that_was_set(inbound, tmp_path):
    before = datetime.now(UTC).replace(microsecond=0)
    folder = submit(inbound, 'alice', ALICE)
    os.utime(folder / f'{LESSON}.ipynb', (0, 0))
    os.utime(folder, (0, 0))
    (one,), _ = match(list(read_upload(inbound, tmp_path)), [LESSON])
    assert before <= one.handed_in <= datetime.now(UTC)
    assert one.secret.read_text() == 'aa'


@needs_root
@pytest.mark.parametrize('owner', [BOB, 0])
def test_a_file_of_another_user_in_a_students_folder_is_refused(owner, inbound, tmp_path):
    folder = submit(inbound, 'alice', ALICE)
    os.chown(folder / f'{LESSON}.ipynb', owner, owner)
    assert collected(inbound, tmp_path) == (
        {},
        ['it is not of the user whose folder it is in'],
    )


@needs_root
def test_files_of_other_users_in_an_instructors_folder_are_left_out(inbound, tmp_path):
    """Bob's own package is taken, though alice put one of the same name before it."""
    theirs = inbound / 'bob'
    theirs.mkdir()
    theirs.chmod(0o1777)
    put(theirs / f'{LESSON}.ipynb', BOB)
    put(theirs / 'own.py', BOB)
    put(theirs / 'helper.py', ALICE)
    put(theirs / SECRET, ALICE)
    put(theirs / 'greeter' / 'setup.py', ALICE)
    put(theirs / 'greeter (1)' / 'setup.py', BOB)
    put(theirs / 'greeter (1)' / 'evil.py', ALICE)
    (one,), left = match(
        list(read_upload(inbound, tmp_path, {'greeter'})), [LESSON], packages={LESSON: ['greeter']}
    )
    assert [*one.extra] == ['own.py', 'greeter/setup.py']
    assert one.extra['greeter/setup.py'].read_text() == str(BOB)
    assert one.secret is None
    why = {
        each.incoming.path.removeprefix('bob/'): each.reason
        for each in left
        if each.needs_attention
    }
    assert {*why} == {'helper.py', SECRET, 'greeter/setup.py', 'greeter (1)/evil.py'}
    assert why['helper.py'] == (
        'it is beside the notebook of bob, and the user alice put it there'
    )


@needs_root
@pytest.mark.parametrize('late', ['own.py', 'greeter/greeter/node.py'])
def test_a_later_change_to_another_file_makes_a_submission_later(late, inbound, tmp_path):
    """A package that is finished after the deadline is late, though its notebook was in time."""
    folder = submit(inbound, 'bob', BOB)
    for name in ('own.py', 'greeter/greeter/node.py'):
        put(folder / name, BOB)
    for each in (folder / 'greeter', folder / 'greeter' / 'greeter'):
        os.chown(each, BOB, BOB)
    time.sleep(0.05)
    due = datetime.now(UTC)
    time.sleep(0.05)
    (folder / late).write_text('finished')
    (one,), _ = match(
        list(read_upload(inbound, tmp_path, {'greeter'})), [LESSON], packages={LESSON: ['greeter']}
    )
    assert one.extra[late].read_text() == 'finished'
    assert one.handed_in > due


@needs_root
def test_a_submission_of_a_user_without_a_name_on_the_machine_is_refused(inbound, tmp_path):
    submit(inbound, 'alice', STRANGER)
    whose, reasons = collected(inbound, tmp_path)
    assert whose == {}
    assert reasons == ['it is of user 4003, who has no name on this machine']


@needs_root
def test_a_hard_link_to_another_file_is_refused(inbound, tmp_path):
    work = tmp_path / 'work.ipynb'
    work.write_text('secret')
    os.link(work, inbound / f'bob_{LESSON}.ipynb')
    assert collected(inbound, tmp_path) == ({}, [live_folders.LINK])


def test_files_that_a_platform_wrote_are_assigned_by_their_names(inbound, tmp_path):
    """All files have one owner: the owner of the folder, or the user who collects."""
    submit(inbound, 'alice', os.geteuid(), "alice's")
    submit(inbound, 'bob', os.geteuid(), "bob's")
    whose, reasons = collected(inbound, tmp_path)
    assert (whose, reasons) == ({"alice's": 'alice', "bob's": 'bob'}, [])


@needs_root
def test_files_of_the_owner_of_the_inbound_folder_are_assigned_by_their_names(inbound, tmp_path):
    os.chown(inbound, STRANGER, STRANGER)
    submit(inbound, 'bob', STRANGER, "bob's")
    assert collected(inbound, tmp_path) == ({"bob's": 'bob'}, [])


def test_a_link_swapped_in_between_look_and_read_is_never_followed(inbound, tmp_path, monkeypatch):
    folder = submit(inbound, 'alice', os.geteuid(), 'honest')
    secret, target = tmp_path / 'secret.ipynb', folder / f'{LESSON}.ipynb'
    secret.write_text('secret')
    lstat, swaps = os.lstat, []

    def swapped(path, **options):
        status = lstat(path, **options)
        if path == target.name and not swaps:
            target.unlink()
            target.symlink_to(secret)
            swaps.append(path)
        return status

    monkeypatch.setattr(os, 'lstat', swapped)
    whose, reasons = collected(inbound, tmp_path)
    assert swaps
    assert whose == {}
    assert reasons == ['it cannot be read: Too many levels of symbolic links']


def test_no_link_is_followed_while_links_are_swapped_in_all_the_time(inbound, tmp_path):
    folder = submit(inbound, 'alice', os.geteuid(), 'honest')
    secret, target = tmp_path / 'secret.ipynb', folder / f'{LESSON}.ipynb'
    secret.write_text('secret')
    link, honest = folder / 'link.tmp', folder / 'honest.tmp'
    ended = threading.Event()

    def swap():
        while not ended.is_set():
            link.symlink_to(secret)
            os.replace(link, target)
            honest.write_text('honest')
            os.replace(honest, target)

    swapping = threading.Thread(target=swap)
    swapping.start()
    try:
        seen = set()
        for number in range(200):
            aside = tmp_path / f'aside{number}'
            aside.mkdir()
            for each in read_inbound_entry(inbound, folder.name, aside):
                if each.file and each.parts[-1] == target.name:
                    seen.add(each.file.read_text())
    finally:
        ended.set()
        swapping.join()
    assert 'secret' not in seen
    assert seen <= {'honest'}


def test_a_file_that_grows_while_it_is_read_is_not_taken(inbound, tmp_path, monkeypatch):
    target = submit(inbound, 'alice', os.geteuid(), 'half') / f'{LESSON}.ipynb'
    read = os.read

    def grown(descriptor, size):
        chunk = read(descriptor, size)
        if chunk == b'half':
            with target.open('a') as file:
                file.write(' and more')
        return chunk

    monkeypatch.setattr(os, 'read', grown)
    assert collected(inbound, tmp_path) == ({}, [live_folders.CHANGED])


@needs_root
def test_a_student_with_too_many_files_does_not_affect_other_students(
    inbound, tmp_path, monkeypatch
):
    monkeypatch.setattr(live_folders, 'ONE', {'files': 10, 'bytes': 1_000})
    folder = submit(inbound, 'alice', ALICE)
    for number in range(20):
        (folder / f'{number:02}.py').write_text('x')
        os.chown(folder / f'{number:02}.py', ALICE, ALICE)
    submit(inbound, 'bob', BOB, "bob's")
    whose, reasons = collected(inbound, tmp_path)
    assert whose["bob's"] == 'bob'
    assert reasons == ['too many files: this one and more were not read']


def test_a_folder_with_millions_of_files_is_not_listed_to_its_end(inbound, tmp_path, monkeypatch):
    folder = submit(inbound, 'alice', os.geteuid())
    for number in range(40):
        (folder / f'{number:02}.py').write_text('x')
    (folder / 'deeper').mkdir()
    scan, listed = os.scandir, []

    @contextmanager
    def counted(place):
        with scan(place) as entries:
            yield (listed.append(each.name) or each for each in entries)

    monkeypatch.setattr(os, 'scandir', counted)
    descriptor = os.open(folder, os.O_RDONLY)
    assert len(first_names(descriptor, 7)) == len(listed) == 7
    assert first_names(descriptor, 100) == sorted(os.listdir(folder))
    listed.clear()
    live = LiveFolder(tmp_path, UnpackLimits(files=9, bytes=1_000), lambda parts: False)
    found = list(live.read(folder, ()))
    assert (len(found), len(listed)) == (10, 10)
    assert found[-1].problem.startswith('too many files')
    listed.clear()
    monkeypatch.setattr(serving_inbound, 'MOST_FILES', 5)
    tree = list(serving_inbound._tree(inbound, folder.name, os.lstat(folder)))
    assert (len(tree), len(listed)) == (6, 5)
    os.close(descriptor)


@pytest.fixture
def no_calendar(monkeypatch):
    """Files have a time that no calendar has, as those on a tmpfs may."""
    fstat = os.fstat

    def far(descriptor):
        status = fstat(descriptor)
        return os.stat_result(
            status,
            {'st_mtime': 1e12, 'st_ctime': 1e12}
            | {name: getattr(status, name) for name in ('st_mtime_ns', 'st_ctime_ns')},
        )

    monkeypatch.setattr(os, 'fstat', far)


@pytest.mark.parametrize('owner', [pytest.param(ALICE, marks=needs_root), os.geteuid()])
def test_a_file_with_a_time_beyond_the_calendar_is_taken_without_that_time(
    owner, inbound, tmp_path, no_calendar
):
    folder = submit(inbound, 'alice', owner)
    (folder / 'timestamp.txt').unlink()
    found = [each for each in read_upload(inbound, tmp_path) if each.parts[-1].endswith('.ipynb')]
    assert [(each.problem, each.modified) for each in found] == [('', None)]
    before = datetime.now(UTC)
    assert all(each.changed <= before for each in found if owner == ALICE)
    assert (found[0].changed is None) == (owner != ALICE)


@needs_root
def test_sparse_archives_of_one_student_are_read_up_to_a_limit_together(
    inbound, tmp_path, monkeypatch
):
    """They take no space on the student's disk, and to copy thousands of them takes hours."""
    monkeypatch.setattr(live_folders, 'MAX_ARCHIVE_BYTES', 3_000_000)
    monkeypatch.setitem(live_folders.ONE, 'bytes', 5_000_000)
    folder = submit(inbound, 'alice', ALICE)
    for number, size in enumerate([4_000_000, *[2_400_000] * 5]):
        sparse(folder / f'sparse{number}.zip', size, ALICE)
    aside = tmp_path / 'aside'
    aside.mkdir()
    found = {
        each.parts[-1]: each.problem for each in read_inbound_entry(inbound, folder.name, aside)
    }
    read = [name for name, problem in found.items() if problem.startswith('broken')]
    unread = [name for name, problem in found.items() if 'what came before it' in problem]
    assert read == ['sparse1.zip', 'sparse2.zip']
    assert unread == ['sparse3.zip', 'sparse4.zip', 'sparse5.zip']
    assert found['sparse0.zip'].startswith('over 3 MB')
    assert found[f'{LESSON}.ipynb'] == ''


def sparse(file, size, uid):
    """Make a file of zeros, which takes no space on the disk."""
    with file.open('wb') as opened:
        opened.truncate(size)
    os.chown(file, uid, uid)


@needs_root
def test_sparse_files_in_many_folders_of_one_student_do_not_fill_the_disk(
    inbound, tmp_path, monkeypatch
):
    monkeypatch.setitem(live_folders.OF_USER, 'bytes', 1_000_000)
    for number in range(3):
        folder = submit(inbound, 'alice', ALICE)
        sparse(folder / 'zeros.py', 450_000, ALICE)
        folder.rename(f'{folder}{number}')
    submit(inbound, 'bob', BOB, "bob's")
    found = list(read_upload(inbound, tmp_path))
    problems = [each.problem for each in found if each.parts[-1] == 'zeros.py']
    assert problems[:2] == ['', '']
    assert 'what came before it' in problems[2]
    assert all(each.file for each in found if each.login == 'bob')


@needs_root
def test_all_archives_of_one_student_count_together(inbound, tmp_path, monkeypatch):
    monkeypatch.setitem(live_folders.OF_USER, 'bytes', 1_000_000)
    for student, uid in ('alice', ALICE), ('bob', BOB):
        folder = submit(inbound, student, uid)
        for number in range(3):
            path = folder / f'{number}.zip'
            with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as box:
                box.writestr('zeros.py', bytes(400_000))
            os.chown(path, uid, uid)
    found = [each for each in read_upload(inbound, tmp_path) if each.parts[-1] == 'zeros.py']
    taken = [(each.login, bool(each.file)) for each in found]
    assert taken == [
        (who, is_taken) for who in ('alice', 'bob') for is_taken in (True, True, False)
    ]
