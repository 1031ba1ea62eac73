"""Grading onto a disk that becomes full leaves only whole files, and can be completed."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import survivor
from course_maker import TOY, answered, released_course, submit

from grader.__main__ import main
from grader.course import Course
from grader.storage.records import records

DISK_BYTES = 3_000_000
ROOM_BYTES = (0, 4_096, 150_000, 230_000, 250_000, 270_000, 290_000, 310_000)
"""A backup takes some 200 kB, a rollback journal some 10 kB, a notebook some 5 kB."""


@pytest.mark.slow
@pytest.mark.isolation
def test_grading_stops_on_a_full_disk_with_a_message_and_can_be_completed(tmp_path):
    course = released_course(tmp_path)
    course.seed(TOY, 'ada')
    for student in ('ada', 'bob', 'zoe'):
        submit(course, student, answered(course, f'# {student}\ndef double(x):\n    return 2 * x'))
    disk = tmp_path / 'disk'
    disk.mkdir()
    code = 'import sys, test_full_disk; test_full_disk.on_a_small_disk(*sys.argv[1:])'
    run = subprocess.run(
        [
            *('bwrap', '--dev-bind', '/', '/', '--die-with-parent'),
            *('--size', str(DISK_BYTES), '--tmpfs', str(disk)),
            *(sys.executable, '-c', f'import sys; sys.path[:0] = {sys.path!r}; {code}'),
            *(str(tmp_path), str(disk)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert run.stderr.count('the disk is full') >= 3
    assert run.stderr.count('Traceback') == 0, run.stderr
    assert set(run.stdout.splitlines()[-len(ROOM_BYTES) :]) == {'as on a large disk'}


def on_a_small_disk(root: str, disk: str) -> None:
    """Grade with ever more room on the disk; then make room, and go on."""
    survivor.stand_in(Path(root, 'log'))
    whole = Course.at(Path(root))
    again = []
    for room in ROOM_BYTES:
        course = Course(root=whole.root, gradebook=Path(disk, 'gradebook'))
        shutil.rmtree(course.gradebook, ignore_errors=True)
        shutil.copytree(whole.gradebook, course.gradebook)
        filler = Path(disk, 'filler')
        filler.write_bytes(bytes(shutil.disk_usage(disk).free - room))
        status = main(['grade'], course=course)
        assert status in (0, 1)
        course_files = [p for p in course.gradebook.rglob('*') if p.is_file()]
        assert not [p for p in course_files if p.suffix == '.new']
        for path in course_files:
            if path.suffix in ('.ipynb', '.begun'):
                json.loads(path.read_bytes())
        filler.unlink()
        assert main(['grade'], course=course) == 0
        again.append((records(course), _autograded(course)))
    reference = Course(root=whole.root, gradebook=Path(root, 'large'))
    shutil.copytree(whole.gradebook, reference.gradebook)
    assert main(['grade'], course=reference) == 0
    expected = (records(reference), _autograded(reference))
    for each in again:
        print('as on a large disk' if each == expected else 'DIFFERENT')


def _autograded(course: Course) -> dict[str, bytes]:
    kept = course.folder('autograded', '', '')
    return {str(p.relative_to(kept)): p.read_bytes() for p in kept.rglob('*') if p.is_file()}
