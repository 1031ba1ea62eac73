"""Without a sandbox, no way of grading runs student code."""

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, released_course, submit
from nbclient import NotebookClient

from grader.common.errors import RoomFailure
from grader.kernels.isolation import TRUST
from grader.kernels.provisioner import NAME

WAYS = {
    './course grade': ['-m', 'grader', 'grade'],
    './course grade --workers': ['-m', 'grader', 'grade', '--workers', '1'],
    'a replay': ['-m', 'grader', 'grade', '--seed', 'ab'],
    'nbgrader autograde': ['-m', 'nbgrader', 'autograde', TOY],
    'the formgrader': [
        '-c',
        'import asyncio\n'
        'from nbgrader.apps import NbGrader\n'
        'from nbgrader.apps.api import NbGraderAPI\n'
        'async def grade():\n'
        '    app = NbGrader()\n'
        '    app.initialize([])\n'
        '    api = NbGraderAPI(app.coursedir, parent=app)\n'
        '    said = api.autograde("00_toy", "ada", force=True)\n'
        '    raise SystemExit(said["error"] + said["log"] if not said["success"] else 0)\n'
        'asyncio.run(grade())',
    ],
}  # fmt: skip


@pytest.fixture(scope='module')
def path(tmp_path_factory):
    """The programs of this machine, but for bubblewrap."""
    folder = tmp_path_factory.mktemp('programs')
    for place in os.environ['PATH'].split(os.pathsep):
        for program in Path(place).glob('*'):
            if program.name != 'bwrap' and not (folder / program.name).is_symlink():
                (folder / program.name).symlink_to(program)
    return str(folder)


@pytest.mark.slow
@pytest.mark.parametrize('way', WAYS.values(), ids=WAYS)
def test_each_way_of_grading_without_a_sandbox_runs_nothing(tmp_path, path, way):
    course, mark = released_course(tmp_path / 'course'), tmp_path / 'it_ran'
    submit(course, 'ada', answered(course, f'open({str(mark)!r}, "w")'))
    command = way
    if way[:2] == ['-m', 'grader']:
        start = (
            'import sys; from pathlib import Path; from grader.course import Course; '
            'from grader.__main__ import main; '
            'sys.exit(main(sys.argv[2:], course=Course.at(Path(sys.argv[1]))))'
        )
        command = ['-P', '-c', start, str(course.root), *way[2:]]
    environment = {name: text for name, text in os.environ.items() if name != TRUST}
    done = subprocess.run(
        [sys.executable, *command],
        cwd=course.root,
        env=environment | {'PATH': path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert 'bubblewrap' in done.stderr or 'bwrap' in done.stderr, done.stderr[-2000:]
    assert not mark.exists()


@pytest.mark.usefixtures('signals')
def test_the_sandboxed_kernel_does_not_start_without_a_sandbox(tmp_path, monkeypatch):
    monkeypatch.setattr('grader.sandbox.bubblewrap._HOLD', 'echo no mounts >&2; exit 1')
    mark = tmp_path / 'it_ran'
    cell = nbformat.v4.new_code_cell(f'open({str(mark)!r}, "w")')
    client = NotebookClient(nbformat.v4.new_notebook(cells=[cell]), kernel_name=NAME)
    with pytest.raises(RoomFailure, match='no mounts'):
        client.execute()
    assert not mark.exists()
