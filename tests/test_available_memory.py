import psutil
import pytest

from grader.common.available_memory import available_bytes

GB = 2**30


@pytest.mark.parametrize(
    ('most', 'left'),
    [('max', 10 * GB), (f'{4 * GB}', 2 * GB), (f'{2 * GB}', 0), (f'{99 * GB}', 10 * GB)],
)
def test_available_memory_is_limited_by_the_cgroup(tmp_path, monkeypatch, most, left):
    machine = psutil.virtual_memory()._replace(available=10 * GB)
    monkeypatch.setattr(psutil, 'virtual_memory', lambda: machine)
    assert available_bytes(tmp_path) == 10 * GB
    (tmp_path / 'memory.max').write_text(f'{most}\n')
    (tmp_path / 'memory.current').write_text(f'{3 * GB}\n')
    (tmp_path / 'memory.stat').write_text(f'anon 77\ninactive_file {GB}\n')
    assert available_bytes(tmp_path) == left
