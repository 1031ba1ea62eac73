import errno
import io
import random
import shutil
import stat
import struct
import tarfile
import zipfile

import pytest

from grader.collect import archive_entries, archives
from grader.collect.archives import unpack
from grader.collect.unpack_limits import UnpackLimits

A_ZIP, A_TAR = 'x.zip', 'x.tar.gz'


def zipped(tmp_path, *entries):
    """Write a zip: of each entry its name or ZipInfo, and its content."""
    with zipfile.ZipFile(tmp_path / A_ZIP, 'w', zipfile.ZIP_DEFLATED) as box:
        for name, content in entries:
            box.writestr(name, content)
    return tmp_path / A_ZIP


def tarred(tmp_path, *entries, name=A_TAR, mode='w:gz'):
    with tarfile.open(tmp_path / name, mode) as box:
        for info, content in entries:
            if isinstance(info, str):
                info = tarfile.TarInfo(info)
            info.size = len(content)
            box.addfile(info, io.BytesIO(content))
    return tmp_path / name


def members(archive, *, files=100, size=10_000_000):
    aside = archive.parent / 'aside'
    shutil.rmtree(aside, ignore_errors=True)
    aside.mkdir()
    left = UnpackLimits(files, size)
    found = list(unpack(archive, name=archive.name, aside=aside, left=left, wanted=lambda n: True))
    # in every case: plain files under our own names, and none that the result does not list
    assert set(aside.rglob('*')) == {m.file for m in found if m.file}
    assert all(p.is_file() and not p.is_symlink() for p in aside.iterdir())
    assert {p.name for p in archive.parent.iterdir()} == {'aside', archive.name}
    return found


def said(archive, **allowance):
    """What became of each entry: its content, or why it was refused."""
    return {
        '/'.join(m.parts): m.problem or m.file.read_bytes().decode()
        for m in members(archive, **allowance)
    }


@pytest.mark.parametrize('make', [zipped, tarred])
def test_files_are_unpacked_and_listed_by_their_paths(make, tmp_path):
    archive = make(tmp_path, ('ada/a.ipynb', b'one'), ('./Ångström/小明.py', b'two'))
    assert said(archive) == {'ada/a.ipynb': 'one', 'Ångström/小明.py': 'two'}


@pytest.mark.parametrize(
    ('suffix', 'mode'),
    [('.tar', 'w'), ('.tgz', 'w:gz'), ('.tar.bz2', 'w:bz2'), ('.tar.xz', 'w:xz'), ('.TAR', 'w')],
)
def test_every_kind_of_tar_is_read(suffix, mode, tmp_path):
    archive = tarred(tmp_path, ('a.py', b'one'), name=f'x{suffix}', mode=mode)
    assert archive_entries.ARCHIVE.search(archive.name)
    assert said(archive) == {'a.py': 'one'}


@pytest.mark.parametrize('make', [zipped, tarred])
@pytest.mark.parametrize(
    ('path', 'problem'),
    [
        ('../out.py', 'leads out of the archive'),
        ('a/../../out.py', 'leads out of the archive'),
        ('..\\out.py', 'leads out of the archive'),
        ('/etc/passwd', 'an absolute one'),
        ('\\\\server\\out.py', 'an absolute one'),
        ('C:\\Users\\out.py', 'an absolute one'),
        ('a/' * 20 + 'a.py', 'more than 20 folders deep'),
        ('a' * 300, 'longer than a file system takes'),
        ('./.', 'it has no name'),
    ],
)
def test_a_path_that_leads_elsewhere_is_refused_and_the_next_file_is_read(
    make, path, problem, tmp_path
):
    refused, fine = members(make(tmp_path, (path, b'bad'), ('b.py', b'good')))
    assert problem in refused.problem
    assert fine.file.read_bytes() == b'good'


def test_backslashes_separate_folders_in_a_path(tmp_path):
    assert said(zipped(tmp_path, ('ada\\00_toy\\a.py', b'x'))) == {'ada/00_toy/a.py': 'x'}


@pytest.mark.parametrize('flagged', [True, False])
def test_a_name_in_utf8_is_read_with_and_without_the_utf8_flag(flagged, tmp_path):
    name = 'Zoë/a.py' if flagged else 'Zoë/a.py'.encode().decode('cp437')
    archive = zipped(tmp_path, (name, b'x'))
    if not flagged:
        content = bytearray(archive.read_bytes())
        utf8 = struct.pack('<H', 0x800)
        for header, at in ((b'PK\x03\x04', 6), (b'PK\x01\x02', 8)):
            start = content.index(header) + at
            assert content[start : start + 2] == utf8
            content[start : start + 2] = b'\0\0'
        wrong = name.encode()
        right = 'Zoë/a.py'.encode()
        content = content.replace(wrong, right + b'_' * (len(wrong) - len(right)))
        archive.write_bytes(content)
    (path,) = said(archive)
    assert path.rstrip('_') == 'Zoë/a.py'


def test_decomposed_letters_are_composed(tmp_path):
    assert list(said(zipped(tmp_path, ('Zoe\u0308/a.py', b'x')))) == ['Zo\u00eb/a.py']


@pytest.mark.parametrize(
    ('kind', 'problem'),
    [(stat.S_IFLNK, 'a link'), (stat.S_IFCHR, 'a device'), (stat.S_IFIFO, 'a device')],
)
def test_a_zip_s_links_and_devices_are_refused(kind, problem, tmp_path):
    info = zipfile.ZipInfo('a.py')
    info.external_attr = (kind | 0o777) << 16
    assert said(zipped(tmp_path, (info, b'/etc/passwd')))['a.py'].startswith(problem)


@pytest.mark.parametrize(
    ('kind', 'problem'),
    [
        (tarfile.SYMTYPE, 'a link'),
        (tarfile.LNKTYPE, 'a link'),
        (tarfile.CHRTYPE, 'a device'),
        (tarfile.BLKTYPE, 'a device'),
        (tarfile.FIFOTYPE, 'a device'),
        (tarfile.GNUTYPE_SPARSE, 'a device'),
    ],
)
def test_a_tar_s_links_and_devices_are_refused(kind, problem, tmp_path):
    info = tarfile.TarInfo('a.py')
    info.type, info.linkname, info.devmajor, info.devminor = kind, '/etc/passwd', 1, 3
    found = said(tarred(tmp_path, (info, b''), ('b.py', b'good')))
    assert found['a.py'].startswith(problem)
    assert found['b.py'] == 'good'


@pytest.mark.parametrize('make', [zipped, tarred])
def test_files_that_are_too_large_once_unpacked_are_refused(make, tmp_path, monkeypatch):
    monkeypatch.setattr(archives, 'MAX_FILE_BYTES', 1_000_000)
    bomb = ('bomb.py', b'\0' * 3_000_000)
    found = said(make(tmp_path, bomb, ('b.py', b'good')))
    assert found == {'bomb.py': 'over 1 MB once unpacked: a bomb?', 'b.py': 'good'}
    together = [(f'{i}.py', b'\0' * 900_000) for i in range(9)]
    bounded = members(make(tmp_path, *together), size=2_000_000)
    assert sum(m.file.stat().st_size for m in bounded if m.file) <= 2_000_000
    assert 'a bomb?' in bounded[-1].problem


def test_a_zip_that_understates_a_size_is_reported_as_broken(tmp_path):
    archive = zipped(tmp_path, ('a.py', b'x' * 5_000_000))
    archive.write_bytes(
        archive.read_bytes().replace(struct.pack('<I', 5_000_000), struct.pack('<I', 7))
    )
    assert said(archive)['a.py'].startswith('broken: ')


@pytest.mark.parametrize('make', [zipped, tarred])
def test_reading_stops_after_the_allowed_number_of_files(make, tmp_path):
    found = members(make(tmp_path, *((f'{i}.py', b'') for i in range(30))), files=10)
    assert len(found) == 11
    assert found[-1].parts == ()
    assert found[-1].problem.startswith('more files in it than are unpacked')


def test_a_table_of_contents_that_claims_to_be_huge_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr(archive_entries, 'MAX_READ_BYTES', 1_000)
    archive = zipped(tmp_path, *((f'{i:0100}.py', b'') for i in range(20)))
    (refused,) = members(archive)
    assert 'its table of contents claims' in refused.problem
    archive.unlink()
    name = tarfile.TarInfo('a' * 3_000)
    (refused,) = members(tarred(tmp_path, (name, b''), name='x.tar', mode='w'))
    assert 'its table of contents claims' in refused.problem


@pytest.mark.parametrize('name', ['x.zip', 'x.tar', 'x.tgz', 'x.tar.bz2', 'x.tar.xz'])
@pytest.mark.parametrize('content', [b'', b'no archive', b'PK\x03\x04' + b'\0' * 600])
def test_a_file_that_is_not_an_archive_is_reported_as_broken(name, content, tmp_path):
    (tmp_path / name).write_bytes(content)
    (refused,) = members(tmp_path / name)
    assert refused.problem.startswith('broken: ')


@pytest.mark.parametrize(('name', 'mode'), [('x.tar', 'w'), ('x.tgz', 'w:gz')])
@pytest.mark.parametrize('kept', [0.2, 0.5, 0.9])
def test_a_truncated_tar_is_reported_as_broken(name, mode, kept, tmp_path):
    entries = [(f'{i}.py', bytes(range(256)) * 30) for i in range(20)]
    archive = tarred(tmp_path, *entries, name=name, mode=mode)
    whole = archive.read_bytes().rstrip(b'\0')
    archive.write_bytes(whole[: int(len(whole) * kept)])
    *fine, last = members(archive)
    assert last.problem.startswith('broken')
    assert len(fine) < 20


def test_a_damaged_file_does_not_keep_the_others_from_being_read(tmp_path):
    archive = zipped(tmp_path, ('a.py', b'damaged' * 100), ('b.py', b'good'))
    content = bytearray(archive.read_bytes())
    content[40:44] = b'\xff\xff\xff\xff'
    archive.write_bytes(content)
    found = said(archive)
    assert found['a.py'].startswith('broken: ')
    assert found['a.py'].endswith('; get it again, or collect the folder that it was made from')
    assert found['b.py'] == 'good'


def test_a_tar_with_a_damaged_header_in_the_middle_is_reported_as_broken(tmp_path):
    archive = tarred(tmp_path, ('a.py', b'x' * 512), ('b.py', b'y'), name='x.tar', mode='w')
    content = bytearray(archive.read_bytes())
    content[1024:1536] = b'?' * 512
    archive.write_bytes(content)
    *_, last = members(archive)
    assert last.problem.startswith('broken')


def test_an_encrypted_file_is_reported_and_the_next_one_is_read(tmp_path):
    archive = zipped(tmp_path, ('a.py', b'x'), ('b.py', b'y'))
    content = bytearray(archive.read_bytes())
    content[content.index(b'PK\x01\x02') + 8] |= 1
    archive.write_bytes(content)
    found = said(archive)
    assert found['a.py'].startswith('encrypted: ')
    assert found['b.py'] == 'y'


@pytest.mark.parametrize('number', [errno.ENOSPC, errno.EDQUOT, errno.EMFILE, errno.ENFILE])
def test_a_lack_of_space_or_files_is_not_blamed_on_the_archive(tmp_path, monkeypatch, number):
    def full(*_, **__):
        raise OSError(number, 'No space left on device')

    monkeypatch.setattr(archives, 'copy_at_most', full)
    archive = zipped(tmp_path, ('a.py', b'x'))
    with pytest.raises(OSError, match='No space'):
        members(archive)


@pytest.mark.parametrize('name', ['x.zip', 'x.tar', 'x.tgz', 'x.tar.xz'])
def test_random_damage_is_reported_and_no_file_is_written_elsewhere(name, tmp_path):
    rolls = random.Random(name)
    content = [(f'a{i}/b{i}.py', rolls.randbytes(rolls.randrange(900))) for i in range(4)]
    mode = {'x.tar': 'w', 'x.tgz': 'w:gz', 'x.tar.xz': 'w:xz'}.get(name)
    make = tarred(tmp_path, *content, name=name, mode=mode) if mode else zipped(tmp_path, *content)
    whole = make.read_bytes()
    complaints = 0
    for _ in range(150):
        damaged = bytearray(whole)
        for _ in range(rolls.randrange(1, 6)):
            place = rolls.randrange(len(damaged))
            damaged[place : place + rolls.randrange(3)] = rolls.randbytes(rolls.randrange(3))
        make.write_bytes(damaged)
        complaints += any(member.problem for member in members(make))  # which looks at the rest
    assert complaints


def test_times_of_files_are_kept_unless_they_are_impossible(tmp_path):
    late = tarfile.TarInfo('a.py')
    late.mtime = 1_700_000_000
    never = tarfile.TarInfo('b.py')
    never.mtime = 10**18
    pax = tarred(tmp_path, (late, b''), (never, b''))
    times = [m.modified and m.modified.isoformat() for m in members(pax)]
    assert times == ['2023-11-14T22:13:20+00:00', None]
    pax.unlink()
    info = zipfile.ZipInfo('a.py')
    info.date_time = (2026, 13, 45, 0, 0, 0)
    assert members(zipped(tmp_path, (info, b'')))[0].modified is None
