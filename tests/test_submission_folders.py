"""Submissions are compared only by plain files, up to a maximum number."""

import os

import pytest

from grader.collect import submission_folders
from grader.collect.submission_folders import contents, contents_of_earlier
from grader.common.errors import TaskFailed


@pytest.fixture
def folder(tmp_path):
    (tmp_path / 'package/src').mkdir(parents=True)
    for name in ('a.ipynb', 'timestamp.txt', 'package/src/b.py'):
        (tmp_path / name).write_text(name)
    return tmp_path


def test_a_submission_differs_if_the_content_of_a_file_differs(folder):
    before = contents(folder)
    assert list(before) == ['a.ipynb', 'package/src/b.py']
    (folder / 'package/src/b.py').write_text('another')
    assert contents(folder) != before


def test_symbolic_links_and_pipes_in_a_submission_are_ignored(folder):
    """A link to /proc/self/mem could not be read, and no other submission was graded then."""
    before = contents(folder)
    (folder / 'memory.py').symlink_to('/proc/self/mem')
    (folder / 'elsewhere').symlink_to('/proc/self')
    (folder / 'loop').symlink_to(folder)
    os.mkfifo(folder / 'pipe.py')
    assert contents(folder) == before


def test_an_earlier_submission_is_read_once_and_again_only_if_changed(tmp_path, monkeypatch):
    """Reading all of them for each further submission delayed the other students."""
    for number in range(3):
        (tmp_path / f'{number}/submitted').mkdir(parents=True)
        (tmp_path / f'{number}/submitted/a.ipynb').write_text(f'{number}')
    read, digest = [], submission_folders._digest
    monkeypatch.setattr(
        submission_folders, '_digest', lambda path: read.append(path) or digest(path)
    )
    first = contents_of_earlier(tmp_path)
    assert len(read) == 3
    assert contents_of_earlier(tmp_path) == first == [contents(p) for p in tmp_path.glob('*/*')]
    del read[:]
    changed = tmp_path / '1/submitted/a.ipynb'
    changed.write_text('changed by hand')
    assert contents_of_earlier(tmp_path) != first
    assert read == [changed]


@pytest.mark.parametrize('limit', ['MAX_FILES', 'MAX_BYTES', 'MAX_DEPTH'])
def test_a_submission_over_a_limit_is_refused_without_being_read(folder, monkeypatch, limit):
    monkeypatch.setattr(submission_folders, limit, 20 if limit == 'MAX_BYTES' else 1)
    monkeypatch.setattr(submission_folders, 'digests', None)
    with pytest.raises(TaskFailed, match='remove what is no part of the submission') as refused:
        contents(folder)
    assert str(folder) in str(refused.value)


def test_a_submission_of_a_thousand_nested_folders_is_refused(tmp_path):
    here = os.open('.', os.O_RDONLY)
    try:
        os.chdir(tmp_path)
        for _ in range(1_100):
            os.mkdir('d')
            os.chdir('d')
        os.fchdir(here)
        with pytest.raises(TaskFailed, match='folders in each other'):
            contents(tmp_path)
    finally:
        os.chdir(tmp_path)
        for _ in range(1_100):
            os.chdir('d')
        for _ in range(1_100):
            os.chdir('..')
            os.rmdir('d')
        os.fchdir(here)
        os.close(here)
