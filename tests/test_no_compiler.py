"""A machine without gcc, CMake and make: the interfaces are there, and their lesson is graded."""

import csv
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from fresh_machine import COMPILERS, fresh_clone, fresh_environment

UV = Path(sys.prefix, 'bin/uv')
LESSON = '08_services'
POINTS = {'ik_service_answers': 2, 'ik_service_unreachable': 1}
POINTS |= {'ik_client_asks': 2, 'ik_client_never_blocks': 2}
BUILDERS = ('gcc', 'cc', 'x86_64-linux-gnu-gcc-12', 'g++', 'c++', 'clang-19', 'cmake', 'make')
OTHERS = ('gccgo-report', 'make-ssl-cert', 'ccache-stats', 'bwrap', 'git')


def test_compilers_and_build_tools_are_known_by_their_names():
    assert [name for name in BUILDERS if not COMPILERS.fullmatch(name)] == []
    assert [name for name in OTHERS if COMPILERS.fullmatch(name)] == []


@pytest.mark.slow
@pytest.mark.isolation
@pytest.mark.timeout(1800)
def test_the_lesson_on_services_runs_and_is_graded_without_a_compiler(tmp_path):
    clone, environment = fresh_clone(tmp_path / 'clone'), fresh_environment(tmp_path)
    # downloading is not under test: the packages may come from this machine's cache
    (tmp_path / 'tools/uv').symlink_to(UV)
    cache = subprocess.run([UV, 'cache', 'dir'], capture_output=True, text=True, check=True)
    environment['UV_CACHE_DIR'] = cache.stdout.strip()
    assert [name for name in BUILDERS if shutil.which(name, path=environment['PATH'])] == []

    def run(*command):
        done = subprocess.run(command, cwd=clone, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, f'{command}\n{done.stdout}\n{done.stderr}'
        return done.stdout

    run('./course', 'doctor')  # the first call sets everything up
    lesson = clone / 'solutions' / LESSON / f'{LESSON}.ipynb'
    execute = ('.venv/bin/jupyter', 'nbconvert', '--to', 'notebook', '--execute')
    run(*execute, '--output-dir', tmp_path / 'executed', lesson)
    executed = nbformat.read(tmp_path / 'executed' / lesson.name, as_version=4)
    code = [cell for cell in executed.cells if cell.cell_type == 'code']
    assert all(cell.execution_count for cell in code if cell.source.strip())

    submitted = tmp_path / 'submitted/ada' / lesson.name
    submitted.parent.mkdir(parents=True)
    shutil.copy(lesson, submitted)
    run('./course', 'validate', submitted)
    run('./course', 'collect', submitted.parents[1])
    assert '1 graded' in run('./course', 'grade', LESSON)
    scores = run('./course', 'scores').strip()
    with open(scores, encoding='utf-8-sig', newline='') as file:
        rows = [row for row in csv.DictReader(file) if row['assignment'] == LESSON]
    assert {row['grade_id']: float(row['score']) for row in rows} == POINTS
    shutil.rmtree(clone / '.venv')
