import errno
import os

import pytest

from grader.common import files
from grader.common.files import write_whole


@pytest.mark.parametrize('content', ['né\r\n', b'\x00\xff'])
def test_write_whole_replaces_a_file_with_the_content_alone(tmp_path, content):
    path = tmp_path / 'a.txt'
    path.write_text('longer than what comes')
    write_whole(path, content)
    assert path.read_bytes() == (content.encode() if isinstance(content, str) else content)
    assert os.listdir(tmp_path) == ['a.txt']


@pytest.mark.parametrize('step', ['fsync', 'replace'])
def test_a_full_disk_leaves_the_former_file_in_place(tmp_path, monkeypatch, step):
    def full(*_):
        raise OSError(errno.ENOSPC, 'No space left on device')

    path = tmp_path / 'a.txt'
    path.write_text('before')
    monkeypatch.setattr(files.os, step, full)
    with pytest.raises(OSError, match='No space'):
        write_whole(path, 'after')
    assert path.read_text() == 'before'
    assert os.listdir(tmp_path) == ['a.txt']


def test_a_file_name_that_is_too_long_raises_its_own_error(tmp_path):
    with pytest.raises(OSError, match='File name too long') as refused:
        write_whole(tmp_path / ('x' * 255), '')
    assert not isinstance(refused.value.__context__, OSError)
    assert os.listdir(tmp_path) == []
