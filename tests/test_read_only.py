"""A read-only gradebook: each verb reports that, and no stored file changes."""

import errno
import subprocess
import sys
from pathlib import Path

import pytest
from course_maker import TOY, released_course, submit

from grader.__main__ import main
from grader.common.errors import GradebookError
from grader.course import Course
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
    gradebook = str(course.gradebook)
    run = subprocess.run(
        [
            *('bwrap', '--dev-bind', '/', '/', '--die-with-parent'),
            *('--ro-bind', gradebook, gradebook),
            *(sys.executable, '-c', PROGRAM.format(verbs=verbs), str(tmp_path)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert 'Traceback' not in run.stderr
    ended = [line for line in run.stdout.splitlines() if ' ends with ' in line]
    assert ended == [f'{" ".join(verb)} ends with 1' for verb in verbs]
    refused = [line for line in run.stderr.splitlines() if line.startswith('course: ')]
    assert len(refused) == len(verbs), run.stderr
    for line in refused:
        assert line.startswith(f'course: {gradebook}')
        assert ' cannot be written: ' in line
        assert ' What was stored before is kept. Give this user the right to write there' in line
    assert _files(course) == before


@pytest.mark.parametrize('code', [errno.EACCES, errno.EPERM, errno.EROFS])
def test_the_path_of_a_refused_write_is_named(tmp_path, code):
    course, path = Course.at(tmp_path), tmp_path / 'gradebook' / 'deadlines.toml'
    said = f'^{path} cannot be .*then run the same command'
    with pytest.raises(GradebookError, match=said), raise_gradebook_errors(course):
        raise OSError(code, 'refused', str(path))
    with pytest.raises(OSError, match='refused'), raise_gradebook_errors(course):
        raise OSError(code, 'refused')  # of a process or a socket


def _files(course: Course) -> dict[Path, bytes]:
    found = course.gradebook.rglob('*')
    return {path: path.read_bytes() for path in found if path.is_file()}
