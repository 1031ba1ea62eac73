"""Which files of a submitted package count, and what the notes say about the others."""

import os

import pytest
from my_robot_basics.session import package_files
from my_robot_basics.session.package_files import MAX_BYTES, MAX_FILES, read, reason_left_out
from package_maker import make_package


@pytest.fixture
def folder(tmp_path):
    return make_package(tmp_path)


def test_all_files_of_a_new_package_are_taken(folder):
    found = read(folder)
    assert {*found.taken} == {
        *('package.xml', 'setup.py', 'setup.cfg', 'resource/greeter'),
        *('greeter/__init__.py', 'greeter/greet.py'),
    }
    assert (found.left_out, found.problem) == ((), '')


@pytest.mark.parametrize(
    ('path', 'reason'),
    [
        ('build/x.py', 'made by a build'),
        ('install/greeter/setup.bash', 'made by a build'),
        ('log/latest.log', 'made by a build'),
        ('greeter/venv/a.py', 'left behind'),
        ('greeter.egg-info/PKG-INFO', 'left behind'),
        ('.git/config', 'hidden'),
        ('greeter/.env', 'hidden'),
        ('greeter/a\nb.py', 'its name is not made of'),
        ('greeter/\x1b[2J.py', 'its name is not made of'),
        ('greeter/<img src=x>.py', 'its name is not made of'),
        ('greeter/-rf', 'its name is not made of'),
        (f'greeter/{"a" * 101}', 'longer than 100 bytes'),
        ('a/b/c/d/e/f/g/h/i', 'more than 8 folders deep'),
    ],
)
def test_a_file_that_is_left_out_is_named_with_the_reason(folder, path, reason):
    (folder / path).parent.mkdir(parents=True, exist_ok=True)
    (folder / path).write_text('')
    found = read(folder)
    [clause] = found.left_out
    assert reason in clause
    assert clause.isprintable()
    assert len(found.taken) == 6


@pytest.mark.parametrize('path', ['greeter/log/a.py', 'größe/ünï.md', 'a b.txt', 'config/a.yaml'])
def test_a_students_own_file_is_taken(path):
    assert reason_left_out(path.split('/')) == ''


def test_no_link_is_followed_and_no_device_read(folder):
    (folder / 'passwd').symlink_to('/etc/passwd')
    (folder / 'etc').symlink_to('/etc')
    os.mkfifo(folder / 'pipe')
    found = read(folder)
    assert len(found.taken) == 6
    assert sorted(found.left_out) == [
        'etc (a link: only files are taken)',
        'passwd (a link: only files are taken)',
        'pipe (a device or the like: only files are taken)',
    ]


def test_a_package_with_too_many_files_is_not_taken_in_part(folder):
    (folder / 'data').mkdir()
    for number in range(MAX_FILES):
        (folder / 'data' / f'{number}').touch()
    found = read(folder)
    assert found.taken == {}
    assert found.problem == (
        'it has 206 files, and at most 200 are taken: remove what is no part of the package '
        '(most are in data/)'
    )


def test_a_package_that_is_too_large_is_refused(folder):
    with (folder / 'mesh.stl').open('wb') as file:
        file.truncate(MAX_BYTES + 1)
    assert 'it has 2.0 MB, and at most 2 MB are taken' in read(folder).problem


def test_a_package_with_a_huge_number_of_entries_is_refused(folder, monkeypatch):
    monkeypatch.setattr(package_files, 'MOST_SEEN', 10)
    (folder / 'x').mkdir()
    for number in range(10):
        (folder / 'x' / f'.{number}').touch()
    assert read(folder).problem == 'it has more than 10 files and folders'


def test_a_file_that_became_a_link_meanwhile_is_not_read(folder):
    found = read(folder)
    (folder / 'setup.py').unlink()
    (folder / 'setup.py').symlink_to('/etc/passwd')
    with pytest.raises(OSError, match=r'setup\.py'):
        package_files.write(found.taken, folder.parent / 'copy')


def test_bytecode_files_are_left_out_without_a_note(tmp_path):
    for name in ('greeter/a.py', 'greeter/__pycache__/a.cpython-311.pyc'):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text('')
    found = read(tmp_path)
    assert (list(found.taken), found.left_out) == (['greeter/a.py'], ())
