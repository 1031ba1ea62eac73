"""A read-only gradebook: verbs that write report that, others work, and no stored file changes."""

import errno
import subprocess
import sys
from pathlib import Path

import pytest
from course_maker import TOY, released_course, submit

from grader.__main__ import main
from grader.common.errors import GradebookError
from grader.course import Course
from grader.serving.queue import WAITING, Arrival
from grader.serving.queue_file import open_queue
from grader.serving.serve import serving_lock
from grader.storage.failures import raise_gradebook_errors

VERBS = (
    ['grade'],
    ['collect', 'source'],
    ['scores'],
    ['scores', '--totals'],
    ['feedback'],
    ['due', TOY, '2026-11-30'],
    ['solutions'],
    ['serve', 'source', '--once'],
)
PROGRAM = """
import sys
from pathlib import Path
from grader.__main__ import main
from grader.course import Course
course = Course.at(Path(sys.argv[1]))
for verb in {verbs}:
    print(*verb, 'ends with', main(verb, course=course), flush=True)
    print(*verb, file=sys.stderr, flush=True)
"""


@pytest.mark.isolation
def test_each_verb_says_that_a_read_only_gradebook_cannot_be_written(tmp_path):
    course = released_course(tmp_path)
    submit(course, 'ada', b'')
    assert main(['grade'], course=course) == 0
    source = tmp_path / 'source'
    source.mkdir()
    (source / f'bob_{TOY}.ipynb').write_text('{}')
    before = _files(course)
    verbs = [[str(source) if each == 'source' else each for each in verb] for verb in VERBS]
    run = _run_read_only(course, verbs)
    assert run.returncode == 0, run.stderr
    assert 'Traceback' not in run.stderr
    ended = [line for line in run.stdout.splitlines() if ' ends with ' in line]
    assert ended == [f'{" ".join(verb)} ends with 1' for verb in verbs]
    refused = [line for line in run.stderr.splitlines() if line.startswith('course: ')]
    assert len(refused) == len(verbs), run.stderr
    for line in refused:
        assert line.startswith(f'course: {course.gradebook}')
        assert ' cannot be written: ' in line
        assert ' What was stored before is kept. Give this user the right to write there' in line
    assert _files(course) == before


@pytest.mark.isolation
def test_the_status_of_serve_is_read_in_a_read_only_gradebook(tmp_path):
    course, inbound = Course.at(tmp_path), tmp_path / 'inbound'
    (tmp_path / 'nbgrader_config.py').touch()
    inbound.mkdir()
    with open_queue(course.gradebook, inbound) as queue:
        queue.add('ada', '1', [Arrival(0, 'ada', 0.0, WAITING, 'ada', TOY)])
    with serving_lock(course):
        served = _run_read_only(course, [['serve', '--status']])
    ended = _run_read_only(course, [['serve', '--status']])
    for run, first in ((served, './course serve runs.'), (ended, './course serve does not run')):
        assert run.returncode == 0, run.stderr
        assert run.stdout.startswith(first), run.stderr
        assert f'{TOY} of ada' in run.stdout
        assert 'serve --status ends with 0' in run.stdout


@pytest.mark.parametrize('code', [errno.EACCES, errno.EPERM, errno.EROFS])
def test_the_path_of_a_refused_write_is_named(tmp_path, code):
    course, path = Course.at(tmp_path), tmp_path / 'gradebook' / 'deadlines.toml'
    said = f'^{path} cannot be .*then run the same command'
    with pytest.raises(GradebookError, match=said), raise_gradebook_errors(course):
        raise OSError(code, 'refused', str(path))
    with pytest.raises(OSError, match='refused'), raise_gradebook_errors(course):
        raise OSError(code, 'refused')  # of a process or a socket


def _run_read_only(course: Course, verbs: list[list[str]]) -> subprocess.CompletedProcess[str]:
    gradebook = str(course.gradebook)
    return subprocess.run(
        [
            *('bwrap', '--dev-bind', '/', '/', '--die-with-parent'),
            *('--ro-bind', gradebook, gradebook),
            *(sys.executable, '-c', PROGRAM.format(verbs=verbs), str(course.root)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )


def _files(course: Course) -> dict[Path, bytes]:
    found = course.gradebook.rglob('*')
    return {path: path.read_bytes() for path in found if path.is_file()}
