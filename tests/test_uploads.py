import io
import os
import tarfile
import zipfile
from pathlib import Path

import pytest

from grader.collect import archive_entries, live_folders, uploads
from grader.collect.unpack_limits import UnpackLimits
from grader.collect.uploads import read_archive_as_json, read_upload
from grader.common.errors import CourseError


@pytest.fixture
def source(tmp_path):
    folder = tmp_path / 'source'
    folder.mkdir()
    return folder


def zip_of(**files):
    """A zip in memory; `__` in a name stands for a slash, `_` before its ending for a dot."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, 'w') as box:
        for name, content in files.items():
            box.writestr('.'.join(name.replace('__', '/').rsplit('_', 1)), content)
    return packed.getvalue()


def seen(source, tmp_path):
    aside = tmp_path / 'aside'
    aside.mkdir(exist_ok=True)
    found = list(read_upload(source, aside))
    return {each.path: each.problem or (each.file and each.file.read_bytes()) for each in found}


def test_files_of_an_uploaded_folder_are_read_and_copied(source, tmp_path):
    (source / 'ada').mkdir()
    (source / 'ada/a.ipynb').write_text('x')
    (source / 'b.py').write_text('y')
    assert seen(source, tmp_path) == {'ada/a.ipynb': b'x', 'b.py': b'y'}
    copies = [each.read_text() for each in (tmp_path / 'aside').iterdir()]
    assert sorted(copies) == ['x', 'y']  # nobody can change these copies


def test_a_single_notebook_is_read_as_an_upload_of_one_file(source, tmp_path):
    (source / 'ada_a.ipynb').write_text('x')
    assert seen(source / 'ada_a.ipynb', tmp_path) == {'ada_a.ipynb': b'x'}


@pytest.mark.parametrize('name', ['nowhere', 'notes.txt', 'class.rar'])
def test_an_upload_of_another_kind_is_refused_in_a_sentence(name, source, tmp_path):
    if name != 'nowhere':
        (source / name).touch()
    with pytest.raises(CourseError, match='expected a folder, a notebook or an archive'):
        seen(source / name, tmp_path)


@pytest.mark.parametrize(
    ('name', 'why'),
    [
        ('a.ipynb.txt', 'a notebook with another ending: rename it'),
        ('a.ipynb.JSON', 'a notebook with another ending: rename it'),
        ('a.ipynb (1)', 'a notebook with another ending: rename it'),
        ('a.eml', 'a mail: save its attachments'),
        ('a.ipynb~', None),
        ('Pose.msg', None),
    ],
)
def test_a_file_that_may_be_the_only_submission_is_not_passed_over(name, why, source, tmp_path):
    (source / 'ada').mkdir()
    (source / 'ada' / name).write_text('x')
    with zipfile.ZipFile(source / 'bob.zip', 'w') as box:
        box.writestr(name, 'x')
    found = seen(source, tmp_path)
    assert len(found) == 2
    for problem in found.values():
        assert problem is None if why is None else problem.startswith(why)


def test_archives_in_archives_are_unpacked_and_named_like_folders(source, tmp_path):
    inner = zip_of(a_ipynb='x', notes_txt='never unpacked')
    (source / 'class.zip').write_bytes(zip_of(ada_zip=inner, b_py='y'))
    assert seen(source / 'class.zip', tmp_path) == {
        'ada.zip/a.ipynb': b'x',
        'ada.zip/notes.txt': None,
        'b.py': b'y',
    }
    (found,) = (each for each in read_upload(source, tmp_path) if each.parts[-1] == 'a.ipynb')
    assert found.parts[: found.archive] == ('class.zip',)


def test_a_broken_inner_archive_does_not_affect_other_files(source, tmp_path):
    (source / 'class.zip').write_bytes(
        zip_of(ada_zip='no zip', bob_zip=zip_of(a_ipynb='x'), c_rar='', d_7z='')
    )
    found = seen(source / 'class.zip', tmp_path)
    assert found.pop('ada.zip').startswith('broken')
    assert (
        found.pop('c.rar')
        == found.pop('d.7z')
        == ('an archive of another kind: ask for a .zip or .tar.gz')
    )
    assert found == {'bob.zip/a.ipynb': b'x'}


def test_archives_nested_too_deeply_are_refused(source, tmp_path):
    packed = zip_of(a_ipynb='x')
    for _ in range(6):
        packed = zip_of(in_zip=packed)
    (source / 'x.zip').write_bytes(packed)
    ((path, problem),) = seen(source, tmp_path).items()
    assert path == 'x.zip/in.zip/in.zip/in.zip'
    assert problem == 'more than 3 archives within each other'


def test_an_archive_bomb_of_one_student_leaves_room_for_others(source, tmp_path, monkeypatch):
    monkeypatch.setattr(uploads, 'ONE', {'files': 20, 'bytes': 1_000})
    for student in ('ada', 'bob'):
        files = {f'f{i}_py': 'x' * 100 for i in range(30)}
        (source / f'{student}.zip').write_bytes(zip_of(**files))
    (source / 'eve.zip').write_bytes(zip_of(a_ipynb='x'))
    found = seen(source, tmp_path)
    assert found['eve.zip/a.ipynb'] == b'x'
    for student in ('ada', 'bob'):
        assert 'more files in it than are unpacked' in found[f'{student}.zip']


MANY = {
    'Moodle': ('Ada Lovelace_11_assignsubmission_file_/{}.zip', 'Zoe_12_assignsubmission_file_'),
    'Canvas': ('lovelaceada_1234_5678_{}.zip', 'zoeang_1235_5679_'),
}


@pytest.mark.parametrize(('many', 'other'), MANY.values(), ids=MANY)
def test_many_archives_of_one_student_leave_room_for_others(
    source, tmp_path, monkeypatch, many, other
):
    """Twenty archives of 5,000 empty files each would use up what a class may have."""
    for name, files in ('ONE', 20), ('OF_USER', 40), ('ALL', 90):
        monkeypatch.setattr(uploads, name, {'files': files, 'bytes': 10_000})
    last = f'{other}/x.zip' if '/' in many else f'{other}x.zip'
    for path in *(many.format(number) for number in range(8)), last:
        (source / path).parent.mkdir(exist_ok=True)
        files = {f'f{number}_py': '' for number in range(18)}
        (source / path).write_bytes(zip_of(**(files if path != last else {'a_ipynb': 'x'})))
    found = seen(source, tmp_path)
    assert found[f'{last}/a.ipynb'] == b'x'
    taken = {path.rpartition('/')[0] for path in found if path.endswith('.py')}
    assert len(taken) == 3  # four files of the third one


def test_all_archives_of_an_upload_share_one_size_limit(source, tmp_path, monkeypatch):
    monkeypatch.setattr(uploads, 'ALL', {'files': 100, 'bytes': 1_000, 'archive_bytes': 10_000})
    for student in ('ada', 'bob'):
        (source / f'{student}.zip').write_bytes(zip_of(a_py='x' * 600))
    found = seen(source, tmp_path)
    assert found['ada.zip/a.py'] == b'x' * 600
    assert 'a bomb?' in found['bob.zip/a.py']
    whole = UnpackLimits(10, 10)
    part = whole.part(files=4, bytes=40)
    assert (part.files, part.bytes) == (4, 10)


def test_inner_archives_share_the_size_limit_of_their_outer_archive(source, tmp_path, monkeypatch):
    """Forty archives of 150 MB, in a file of 19 kB, took 12 s of processor time."""
    monkeypatch.setattr(uploads, 'ONE', {'files': 100, 'bytes': 100_000})
    large, small = tar_of('large_py', 60_000), tar_of('small_py', 100)
    broken = tar_of('large_py', 60_000)[:-4] + b'    '
    for student, packed in (('ada', large), ('bob', broken)):
        files = {f'{n}_tbz2': packed for n in range(3)} | {'a_ipynb': 'x', 'z_tbz2': small}
        (source / f'{student}.zip').write_bytes(zip_of(**files))
    (source / 'eve.zip').write_bytes(zip_of(z_tbz2=large))
    left, opened = [], archive_entries.copy_at_most

    def copied(source, target, *, most):
        left.append(most)
        return opened(source, target, most=most)

    monkeypatch.setattr(archive_entries, 'copy_at_most', copied)
    monkeypatch.setattr(
        uploads, 'parse', lambda _, *arguments, limits: read_archive_as_json(*arguments)
    )
    found = seen(source, tmp_path)
    assert [round(each, -4) for each in left] == [100_000, 30_000, 100_000, 100_000]
    assert found['ada.zip/a.ipynb'] == found['bob.zip/a.ipynb'] == b'x'
    assert found['ada.zip/0.tbz2/large.py'] == found['eve.zip/z.tbz2/large.py'] == bytes(60_000)
    refused = 'not unpacked, because what came before it was too large together: a bomb?'
    for name in ('ada.zip/2.tbz2', 'ada.zip/z.tbz2', 'bob.zip/1.tbz2', 'bob.zip/z.tbz2'):
        assert found[name].startswith(refused)


def tar_of(name, size):
    """A tar in memory, of one file of zeros."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode='w:bz2') as box:
        info = tarfile.TarInfo('.'.join(name.rsplit('_', 1)))
        info.size = size
        box.addfile(info, io.BytesIO(bytes(size)))
    return packed.getvalue()


def test_symbolic_links_devices_and_files_too_large_are_named(source, tmp_path, monkeypatch):
    monkeypatch.setattr(live_folders, 'MAX_FILE_BYTES', 10)
    secret = tmp_path / 'secret.ipynb'
    secret.write_text('secret')
    (source / 'link.ipynb').symlink_to(secret)
    (source / 'folder').symlink_to(tmp_path)
    os.mkfifo(source / 'pipe.ipynb')
    (source / 'large.ipynb').write_text('x' * 11)
    found = seen(source, tmp_path)
    assert found['link.ipynb'] == found['folder'] == 'a link: only files are taken'
    assert found['pipe.ipynb'] == 'a device or the like: only files are taken'
    assert found['large.ipynb'].startswith('over 0 MB')
    assert len(found) == 4


def test_folders_nested_too_deeply_are_refused(source, tmp_path):
    deep = source.joinpath(*'abcdefghijklmnopqrstuvwxyz')
    deep.mkdir(parents=True)
    ((path, problem),) = seen(source, tmp_path).items()
    assert path.count('/') == 20
    assert 'more than 20 folders deep' in problem


@pytest.mark.skipif(os.geteuid() == 0, reason='root may read anything')
def test_files_and_folders_without_read_permission_are_reported(source, tmp_path):
    (source / 'a.ipynb').touch(mode=0)
    (source / 'folder').mkdir(mode=0)
    assert set(seen(source, tmp_path).values()) == {
        'this user may not read it: check its permissions'
    }


def test_leftover_folders_are_marked_as_litter_and_refused_paths_are_listed(source, tmp_path):
    with tarfile.open(source / 'ada.tar', 'w') as box:
        for name in ('.ipynb_checkpoints/a.ipynb', '__MACOSX/._a.ipynb', 'a.ipynb', '../a.ipynb'):
            box.addfile(tarfile.TarInfo(name))
    (source / '.git').mkdir()
    (source / '.git/a.ipynb').touch()
    found = list(read_upload(source, tmp_path))
    assert [each.path for each in found if not each.is_litter] == [
        'ada.tar/a.ipynb',
        'ada.tar/../a.ipynb',
    ]
    assert next(each.path for each in found if each.is_litter) == '.git'


@pytest.mark.parametrize(
    'name',
    ['Mallory Evil_666_assignsubmission_file_', 'Lab_Mallory Evil_attempt_2026-01-02-03-04-05_'],
)
def test_the_platforms_name_of_an_upload_is_kept_in_its_paths(name, source, tmp_path, monkeypatch):
    (source / name / 'Ada Lovelace').mkdir(parents=True)
    (source / name / 'Ada Lovelace/a.ipynb').write_text('x')
    wanted = {f'{name}/Ada Lovelace/a.ipynb': b'x'}
    assert seen(source / name, tmp_path) == wanted
    monkeypatch.chdir(source / name)
    assert seen(Path('.'), tmp_path) == wanted
    archive = source / f'{name}Ada Lovelace.zip'
    archive.write_bytes(zip_of(a_ipynb='x'))
    assert seen(archive, tmp_path) == {f'{archive.name}/a.ipynb': b'x'}


def test_a_class_folder_with_years_is_not_taken_for_an_upload_of_canvas(source, tmp_path):
    (source / 'ros_2026_2027/ada').mkdir(parents=True)
    (source / 'ros_2026_2027/ada/a.ipynb').write_text('x')
    assert seen(source / 'ros_2026_2027', tmp_path) == {'ada/a.ipynb': b'x'}
