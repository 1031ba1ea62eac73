"""A lesson that asks for a package, from its source to the feedback: one course for all of it."""

import os
import shutil
import subprocess
import sys

import pytest
from given_verdicts import executed
from nbgrader.converters import Autograde
from nbgrader.coursedir import CourseDirectory
from package_maker import LESSON, PACKAGE, make_package, write_lesson
from stand_in import note_tasks, stand_in
from traitlets.config.loader import PyFileConfigLoader

from grader.authoring import bundle as bundling
from grader.authoring.release import release, stale_or_leaking
from grader.course import ROOT, Course
from grader.grade import grade_all
from grader.judging.execute import Execution
from grader.report.feedback import write_feedback
from grader.storage.submitted import find_submissions

pytestmark = pytest.mark.starts


@pytest.fixture(scope='module')
def released(tmp_path_factory):
    """A course of that one lesson, with the instructor's own package beside its source."""
    root = tmp_path_factory.mktemp('course')
    shutil.copy(ROOT / 'nbgrader_config.py', root)
    make_package(write_lesson(root).parent)
    course = Course.at(root)
    release(course)
    return course


@pytest.fixture
def course(released, tmp_path):
    """The course, with a gradebook of its own."""
    return Course(root=released.root, gradebook=tmp_path / 'gradebook')


@pytest.fixture
def worked_in(released):
    """The course with a package beside the released notebook, where students write theirs."""
    folder = make_package(released.root / 'notebooks' / LESSON)
    yield released
    shutil.rmtree(folder)


def test_a_package_is_neither_released_nor_bundled(worked_in):
    assert (worked_in.root / 'solutions' / LESSON / PACKAGE / 'setup.py').is_file()
    assert release(worked_in) == []
    assert stale_or_leaking(worked_in) == []
    listed = {*bundling._paths(worked_in, [])}
    assert f'notebooks/{LESSON}/{LESSON}.ipynb' in listed
    assert [path for path in listed if f'/{PACKAGE}/' in path] == []


@pytest.mark.slow
def test_validate_builds_the_package_beside_the_notebook(worked_in):
    notebook = worked_in.release_path(LESSON)
    command = [sys.executable, '-P', '-m', 'my_robot_basics.validate', str(notebook)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (notebook.parent / PACKAGE / 'resource' / PACKAGE).unlink()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert 'setup.py installs resource/greeter, and there is no such' in ' '.join(
        done.stdout.split()
    )
    assert not {'build', 'install', 'log'} & {*os.listdir(notebook.parent / PACKAGE)}


@pytest.fixture
def seen(monkeypatch):
    """The files of each submission that the worker received, by path."""
    seen = []

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        [folder] = extra_files
        paths = (path for path in folder.rglob('*') if path.is_file())
        seen.append({path.relative_to(folder).as_posix(): path.read_bytes() for path in paths})
        graded = executed(notebook, {'builds': '', 'runs': 'not yet'})
        return Execution(notebook=graded, verdicts=(), notes=())

    stand_in(look, monkeypatch)
    return seen


def test_files_of_a_package_reach_the_worker_and_a_change_is_noticed(course, seen):
    place = course.folder('submitted', 'ada', LESSON)
    place.mkdir(parents=True)
    shutil.copy(course.release_path(LESSON), place)
    folder = make_package(place)
    (folder / 'log').mkdir()
    (folder / 'log' / 'x.log').touch()
    (folder / 'shadow').symlink_to('/etc/shadow')

    def graded():
        [row] = grade_all(course, find_submissions(course))
        return row.reused

    assert not graded()
    assert {*seen[0]} == {
        *('package.xml', 'setup.py', 'setup.cfg', 'resource/greeter'),
        *('greeter/__init__.py', 'greeter/greet.py'),
    }
    kept = course.folder('autograded', 'ada', LESSON)
    assert (kept / PACKAGE / 'setup.py').is_file()
    assert not (kept / PACKAGE / 'shadow').exists()
    assert graded()
    (folder / 'setup.cfg').write_text('# mine')
    (folder / 'greeter' / 'greet.py').unlink()
    assert not graded()
    assert seen[1]['setup.cfg'] == b'# mine'
    assert not (kept / PACKAGE / 'greeter' / 'greet.py').exists()
    [page] = write_feedback(course)
    text = page.read_text(encoding='utf-8')
    assert 'shadow (a link: only files are taken)' in text
    assert 'log (made by a build, which is done again at grading)' in text


def contents(folder):
    """The files of the package in a folder, by their path there."""
    found = (path for path in (folder / PACKAGE).rglob('*') if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def test_nbgrader_autograde_takes_the_students_package_and_not_the_solved_one(
    released, monkeypatch
):
    tasks = note_tasks(
        monkeypatch, lambda notebook: executed(notebook, {'builds': '', 'runs': ''})
    )
    monkeypatch.chdir(released.root)
    place = released.folder('submitted', 'ada', LESSON)
    folder = make_package(place, node='# mine')
    (folder / 'setup.py').unlink()
    shutil.copy(released.release_path(LESSON), place)
    handed_in = contents(place)
    config = PyFileConfigLoader('nbgrader_config.py', path=str(released.root)).load_config()
    course = CourseDirectory(config=config, assignment_id=LESSON, student_id='ada')
    Autograde(coursedir=course, config=config).start()
    [task] = tasks
    assert task.files == handed_in
    assert contents(released.folder('autograded', 'ada', LESSON)) == handed_in
