"""nbgrader's own commands do not parse submitted files themselves."""

import time

import nbformat
import pytest
from course_maker import TOY, make_course, submit
from hostile_papers import ONE_MEGABYTE, STOPS_DATEUTIL
from nbformat.v4 import new_notebook
from nbgrader.converters import Autograde
from nbgrader.coursedir import CourseDirectory
from traitlets.config.loader import PyFileConfigLoader

from grader.autograde.submitted_files import AutogradeExporter, existing_timestamp
from grader.storage.pipeline import AUTOGRADE_PASSES, SANITIZE_PASSES


def exporter_of(passes):
    exporter = AutogradeExporter(config=None)
    exporter._preprocessors = []
    for name in passes:
        exporter.register_preprocessor(name)
    return exporter


@pytest.mark.parametrize(
    'content', [*ONE_MEGABYTE.values(), '', '[' * 100_000, '{}'],
    ids=[*ONE_MEGABYTE, 'nothing', 'nested', 'no notebook'],
)  # fmt: skip
def test_nbgrader_leaves_parsing_a_submitted_notebook_to_another_process(
    tmp_path, content, monkeypatch
):
    path = tmp_path / 'a.ipynb'
    path.write_text(content)
    monkeypatch.setattr(nbformat, 'read', None)
    exporter, seen = exporter_of(SANITIZE_PASSES[:1]), []
    exporter._preprocessors[0].preprocess = lambda *given: seen.append(given[0]) or given
    began = time.process_time()
    exporter.from_filename(str(path))
    assert [notebook.cells for notebook in seen] == [[]]
    assert time.process_time() - began < 1.0  # nbconvert's own: 39 s for the outputs


def test_a_notebook_written_by_nbgrader_is_read_in_full(tmp_path):
    path = tmp_path / 'a.ipynb'
    nbformat.write(new_notebook(cells=[nbformat.v4.new_raw_cell('x')]), path)
    assert 'grader.autograde.preprocessors.ExecuteRooms' in AUTOGRADE_PASSES
    text, _ = exporter_of(()).from_filename(str(path))
    assert [cell.source for cell in nbformat.reads(text, as_version=4).cells] == ['x']


@pytest.fixture
def configured(tmp_path, monkeypatch):
    monkeypatch.setattr(
        CourseDirectory, 'get_existing_timestamp', CourseDirectory.get_existing_timestamp
    )
    course = make_course(tmp_path)
    return course, PyFileConfigLoader('nbgrader_config.py', path=str(course.root)).load_config()


def test_autograde_is_configured_with_our_exporter_and_timestamp_reader(configured):
    _, config = configured
    assert Autograde(config=config).exporter_class is AutogradeExporter
    assert CourseDirectory.get_existing_timestamp is existing_timestamp


@pytest.mark.parametrize(
    ('text', 'when'),
    [
        ('2026-01-02 03:04:05 UTC', '2026-01-02T03:04:05'),
        ('2026-01-02 12:00:00 +0200', '2026-01-02T10:00:00'),
        ('', None),
        (STOPS_DATEUTIL, None),
        ('1' * 1_000_000, None),
        (b'\xff' * 50, None),
    ],
)
def test_nbgrader_reads_a_timestamp_as_our_own_commands_do(configured, text, when):
    course, config = configured
    path = submit(course, 'ada', '').with_name('timestamp.txt')
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    directory = CourseDirectory(config=config)
    found = directory.get_existing_timestamp(str(course.folder('submitted', 'ada', TOY)))
    assert (found and found.isoformat()) == when
