"""Modules that are not imported at first behave, once they are used, as if they had been."""

import json
import os
import re
import subprocess
import sys
import sysconfig
from importlib.metadata import distributions, version

import pytest
from course_maker import TOY, released_course

from grader.common import versions
from grader.storage.lesson_checksums import FOLDER, checksums, lesson_to_register

LEAN = """
import sys
from grader.common.lean_imports import leave_out_servers
leave_out_servers()
import nbgrader.api
left_out = {'nbgrader.server_extensions', 'setuptools', 'requests.api'} - {*sys.modules}
import nbgrader, requests
from nbgrader import utils
from nbgrader.preprocessors import SaveCells
assert left_out == {'nbgrader.server_extensions', 'setuptools', 'requests.api'}, left_out
assert utils.parse_utc('2026-11-30 18:00').hour == 18
assert requests.get.__module__ == 'requests.api'
assert not hasattr(nbgrader, 'nonsense')
assert nbgrader._jupyter_server_extension_points() == [{'module': 'nbgrader'}]
print(nbgrader.__version__)
"""
FORMATS = """
import sys
from grader.common.lean_imports import FORMATS, leave_out_formats
leave_out_formats()
import nbformat, jsonschema
assert not {*FORMATS} & {*sys.modules}
import isoduration
print(isoduration.parse_duration('PT3S').time.seconds)
"""
EARLY = """
import sys
import grader.kernels.isolation
print('nbformat' in sys.modules)
import grader.cli.begin_grade
print('sqlalchemy' in sys.modules)
"""
SERVERS = """
import sys
import grader.workers.begin_worker
print({'asyncio', 'nbformat'} & {*sys.modules})
"""
CACHES = """
import json, sys
from grader.sandbox.font_cache import font_cache
ours, imported = font_cache(), 'matplotlib' in sys.modules
import matplotlib
print(json.dumps([ours, matplotlib.get_cachedir(), imported]))
"""


def said_by(program, **variables):
    names = ('MPLCONFIGDIR', 'XDG_CACHE_HOME')
    environment = {k: v for k, v in os.environ.items() if k not in names} | variables
    command = [sys.executable, '-P', '-c', program]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_modules_left_out_of_nbgrader_are_imported_on_first_use():
    assert said_by(LEAN).strip() == version('nbgrader')


def test_unused_schema_formats_are_not_imported_at_first_but_can_be_later():
    assert said_by(FORMATS).strip() == '3'


def test_the_sandbox_check_and_workers_start_before_slow_imports():
    assert said_by(EARLY).split() == ['False', 'False']


def test_a_worker_starts_its_fork_servers_before_slow_imports():
    assert said_by(SERVERS).strip() == 'set()'


@pytest.mark.parametrize('name', ['MPLCONFIGDIR', 'XDG_CACHE_HOME', 'HOME'])
@pytest.mark.parametrize('there', [True, False])
def test_the_font_cache_is_in_the_folder_of_matplotlib(name, there, tmp_path):
    below = {'MPLCONFIGDIR': '', 'XDG_CACHE_HOME': 'matplotlib', 'HOME': '.cache/matplotlib'}[name]
    folder = tmp_path / 'a folder'
    if there:
        (folder / below).mkdir(parents=True)
    ours, theirs, imported = json.loads(said_by(CACHES, **{name: str(folder)}))
    assert ours == theirs == str(folder / below)
    assert imported is not there


def test_versions_list_name_and_version_of_each_installed_distribution():
    folder = sysconfig.get_path('purelib')
    # wheels write names in either case, and with different separators
    ours = [re.sub('[-_.]+', '-', name).lower() for name in versions._installed(folder)]
    theirs = [
        re.sub('[-_.]+', '-', f'{each.name}-{each.version}-').lower()
        for each in distributions(path=[folder])
    ]
    assert len(ours) == len(theirs) > 100
    assert [name for name in theirs if not any(each.startswith(name) for each in ours)] == []


@pytest.mark.parametrize('kept', ['', '[]', '{"made_from": 1}', '\udcff'])
def test_checksums_that_are_damaged_are_made_anew(kept, tmp_path):
    course = released_course(tmp_path)
    wanted = checksums(course, TOY)
    path = course.gradebook / FOLDER / f'{TOY}.json'
    before = path.read_bytes()
    path.write_text(kept, errors='surrogateescape')
    assert checksums(course, TOY) == wanted
    assert path.read_bytes() == before
    assert wanted == {
        cell.metadata.nbgrader.grade_id: cell.metadata.nbgrader.checksum
        for cell in lesson_to_register(course, TOY).cells
        if 'checksum' in cell.metadata.get('nbgrader', {})
    }


def test_checksums_change_with_the_text_of_their_cell(tmp_path):
    course = released_course(tmp_path)
    before = checksums(course, TOY)
    path = course.source_path(TOY)
    path.write_text(path.read_text().replace('Small numbers are', 'Numbers are'))
    after = checksums(course, TOY)
    assert before.keys() == after.keys()
    assert [name for name in before if before[name] != after[name]] == ['double-check']


def test_checksums_of_another_version_of_the_grader_are_not_used(tmp_path, monkeypatch):
    course = released_course(tmp_path)
    path = course.gradebook / FOLDER / f'{TOY}.json'
    checksums(course, TOY)
    kept = json.loads(path.read_text())
    path.write_text(json.dumps(kept | {'checksums': {'double': 'from another one'}}))
    assert checksums(course, TOY) == {'double': 'from another one'}
    monkeypatch.setattr(
        'grader.storage.lesson_checksums.software_hash', lambda: 'another version of the grader'
    )
    assert checksums(course, TOY) == kept['checksums']
