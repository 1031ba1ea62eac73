"""A damaged or hostile upload, or one that is in the way, affects no other upload."""

import gzip
import os
import tarfile
import tracemalloc
import zipfile

import pytest
from collected import NOTEBOOK, rows, tree, write
from course_maker import TOY

from grader.__main__ import main
from grader.collect import collect as module
from grader.collect import uploads
from grader.collect.collect import AGAIN, LEFT, NEW, UNUSED, collect
from grader.common.errors import CourseError
from grader.common.parsing import Limits


def test_no_archive_writes_outside_of_the_gradebook(course, came_in, tmp_path):
    secret = tmp_path / 'secret'
    secret.write_text('secret')
    link = zipfile.ZipInfo(f'eve/{NOTEBOOK}')
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(came_in / 'class.zip', 'w') as box:
        box.writestr(f'../../../submitted/ada/{TOY}/{NOTEBOOK}', 'slip')
        box.writestr(f'/{tmp_path}/ada/{TOY}/{NOTEBOOK}', 'absolute')
        box.writestr(link, str(secret))
        box.writestr(f'../{TOY}.ipynb', 'slip')
        box.writestr(f'bob\x1b[2J_{TOY}.ipynb', 'escape')
        box.writestr(f'zoe/{TOY}/{NOTEBOOK}', 'fine')
    outside = {path for path in tmp_path.rglob('*') if course.gradebook not in path.parents}
    found = rows(course, came_in / 'class.zip')
    assert sorted(found.values()) == [LEFT] * 5 + [NEW]
    assert {path for path in tmp_path.rglob('*') if course.gradebook not in path.parents} == (
        outside | {course.gradebook}
    )
    assert tree(course.gradebook / 'submitted') == {f'zoe/{TOY}/{NOTEBOOK}': 'fine'}


def test_a_file_in_the_way_of_one_submission_does_not_stop_others(course, came_in):
    write(course.gradebook / 'submitted/ada', 'a file')
    write(came_in / f'ada_{TOY}.ipynb', '')
    write(came_in / f'bob_{TOY}.ipynb', '')
    assert sorted(rows(course, came_in).values()) == [LEFT, NEW]
    assert (course.gradebook / 'submitted/ada').read_text() == 'a file'


@pytest.mark.parametrize('name', ['bob.zip', 'bob.tar.gz'])
def test_an_archive_without_a_file_is_listed_beside_other_submissions(course, came_in, name):
    write(came_in / f'ada_{TOY}.ipynb', 'x')
    (came_in / 'empty').mkdir()
    if name.endswith('.zip'):
        with zipfile.ZipFile(came_in / name, 'w') as box:
            box.write(came_in / 'empty', 'work')
    else:
        with tarfile.open(came_in / name, 'w:gz') as box:
            box.add(came_in / 'empty', 'work')
    said = {row.path: (row.outcome, row.reason) for row in collect(course, came_in)}
    reason = 'there is no file in it: if work is missing, ask for it once more'
    assert said == {f'ada_{TOY}.ipynb': (NEW, ''), name: (LEFT, reason)}
    alone = [(row.path, row.reason) for row in collect(course, came_in / name)]
    assert alone == [(name, reason)]


def test_a_full_disk_is_reported_in_a_sentence(course, came_in, monkeypatch):
    def full(*_):
        raise OSError(28, 'No space left on device')

    write(came_in / f'ada_{TOY}.ipynb', '')
    monkeypatch.setattr(module, 'put_atomically', full)
    with pytest.raises(CourseError, match='the disk is full: what was collected is kept whole'):
        rows(course, came_in)


def test_a_hostile_time_is_refused_and_the_submissions_are_taken(course, came_in):
    write(came_in / f'ada/{TOY}/{NOTEBOOK}', 'ada’s')
    write(came_in / f'ada/{TOY}/timestamp.txt', '1:99999999999999999999999999999.5')
    write(came_in / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    found = {row.path: (row.outcome, row.reason) for row in collect(course, came_in)}
    assert found == {
        f'ada/{TOY}/{NOTEBOOK}': (NEW, ''),
        f'ada/{TOY}/timestamp.txt': (LEFT, 'it holds no date'),
        f'bob/{TOY}/{NOTEBOOK}': (NEW, ''),
    }


def a_tar_of_digits(path):
    """87 kB on which the tar reader of Python 3.11.7 works for hours."""
    header = tarfile.TarInfo('digits')
    header.type, header.size = tarfile.XHDTYPE, 7_900_000
    with gzip.open(path, 'wb') as packed:
        packed.write(header.tobuf(tarfile.USTAR_FORMAT))
        packed.write(b'1' * header.size)
        packed.write(bytes(-header.size % 512))
        packed.write(tarfile.TarInfo('a.ipynb').tobuf() + bytes(1024))


@pytest.mark.slow
def test_an_archive_that_takes_too_long_does_not_stop_other_submissions(
    course, came_in, monkeypatch
):
    monkeypatch.setattr(uploads, 'LIMITS_OF_ONE', Limits(cpu_sec=2))
    for place in (came_in, came_in / f'bob/{TOY}'):
        place.mkdir(parents=True, exist_ok=True)
        a_tar_of_digits(place / 'mallory.tar.gz')
    write(came_in / f'ada_{TOY}.ipynb', 'ada’s')
    found = {row.path: (row.outcome, row.reason) for row in collect(course, came_in)}
    assert found.pop(f'ada_{TOY}.ipynb') == (NEW, '')
    assert {path.rpartition('/')[2] for path in found} <= {'mallory.tar.gz', 'a.ipynb'}
    for outcome, reason in found.values():
        assert outcome == LEFT
        assert 'over 2 s of processor time' in reason or 'named after no assignment' in reason


def test_an_archive_that_takes_too_much_memory_does_not_stop_other_submissions(
    course, came_in, monkeypatch
):
    limits = Limits(memory_bytes=40_000_000)  # the reader itself does not fit in
    monkeypatch.setattr(uploads, 'LIMITS_OF_ONE', limits)
    with zipfile.ZipFile(came_in / 'mallory.zip', 'w') as box:
        box.writestr(NOTEBOOK, 'x' * 10_000_000)
    write(came_in / f'ada_{TOY}.ipynb', 'ada’s')
    assert rows(course, came_in) == {'mallory.zip': LEFT, f'ada_{TOY}.ipynb': NEW}


def test_an_unreadable_file_does_not_stop_other_submissions(course, came_in, monkeypatch):
    """It may be on a damaged disk, or have been removed since the folder was listed."""
    for student in ('ada', 'bob', 'zoe'):
        write(came_in / f'{student}_{TOY}.ipynb', student)
        write(came_in / f'{student}-{TOY}.ipynb', student)
    lstat, read, open_file, opened = os.lstat, os.read, os.open, {}

    def remembered(path, *arguments, **options):
        descriptor = open_file(path, *arguments, **options)
        opened[descriptor] = str(path)
        return descriptor

    def damaged(descriptor, size):
        if opened.get(descriptor, '').startswith('ada'):
            raise OSError(5, 'Input/output error')
        return read(descriptor, size)

    def gone(path, **options):
        if str(path).startswith('bob_'):
            raise FileNotFoundError(2, 'No such file or directory', str(path))
        return lstat(path, **options)

    monkeypatch.setattr(os, 'open', remembered)
    monkeypatch.setattr(os, 'read', damaged)
    monkeypatch.setattr(os, 'lstat', gone)
    assert rows(course, came_in) == {
        f'ada_{TOY}.ipynb': LEFT,
        f'ada-{TOY}.ipynb': LEFT,
        f'bob_{TOY}.ipynb': LEFT,
        f'bob-{TOY}.ipynb': NEW,
        f'zoe-{TOY}.ipynb': NEW,
        f'zoe_{TOY}.ipynb': UNUSED,
    }
    (came_in / f'ada_{TOY}.ipynb').unlink()
    (row,) = (row for row in collect(course, came_in) if row.path.startswith('ada'))
    assert (row.outcome, row.reason) == (LEFT, 'it cannot be read: Input/output error')


def test_thousands_of_broken_files_are_reported_in_under_forty_lines(course, came_in, capsys):
    for student, name in (('mallory', '{}.ipynb'), ('eve', 'a_' + 'z' * 200 + '{}.ipynb')):
        with zipfile.ZipFile(came_in / f'{student}.zip', 'w') as box:
            for number in range(3_000):
                box.writestr(name.format(number), 'x')
        packed = (came_in / f'{student}.zip').read_bytes()
        (came_in / f'{student}.zip').write_bytes(packed.replace(b'x' + b'PK\x03', b'yPK\x03'))
    write(came_in / f'ada_{TOY}.ipynb', 'ada’s')
    for number in range(9):
        write(came_in / f'homework {number}.zip', '')
    assert main(['collect', str(came_in)], course=course) == 1
    out = capsys.readouterr().out
    assert len(out.splitlines()) < 40
    assert max(map(len, out.splitlines())) < 400
    assert '… and 2,996 more like it' in out
    assert out.count('homework') == 9
    assert '1 new; 6009 not taken.' in out


def test_large_files_are_collected_without_holding_them_in_memory(course, came_in):
    """Neither a submission nor the earlier one beside it is in memory as a whole."""
    folder = came_in / f'ada/{TOY}'
    write(folder / NOTEBOOK, 'hers')
    for number in range(4):
        (folder / f'{number}.py').write_bytes(bytes(10_000_000))
    assert NEW in rows(course, came_in).values()
    write(folder / NOTEBOOK, 'hers again')
    write(folder / 'timestamp.txt', '2026-01-02 03:04:05 UTC')
    tracemalloc.start()
    try:
        assert AGAIN in rows(course, came_in).values()
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 10_000_000
