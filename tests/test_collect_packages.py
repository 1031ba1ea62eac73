"""Packages are collected with their notebook, however they were packed, and nothing else is."""

import io
import os
import shutil
import tarfile
import zipfile

import pytest
from colcon_terminal import bash
from my_robot_basics.session.package_files import MAX_FILES
from package_maker import LESSON, PACKAGE, make_package, write_lesson

from grader.collect.collect import AGAIN, KNOWN, LEFT, NEW, UNUSED, collect
from grader.course import Course
from grader.notebook.submission import LEFT_OUT, read_submission

FILES = {
    f'{PACKAGE}/{name}'
    for name in (
        *('package.xml', 'setup.py', 'setup.cfg', 'resource/greeter'),
        *('greeter/__init__.py', 'greeter/greet.py'),
    )
}
NOTEBOOK = f'{LESSON}.ipynb'


@pytest.fixture
def course(tmp_path):
    write_lesson(tmp_path / 'course')
    return Course.at(tmp_path / 'course')


@pytest.fixture
def work(tmp_path):
    """A student's folder of the lesson, with the package in it."""
    folder = tmp_path / 'work'
    make_package(folder)
    (folder / NOTEBOOK).write_text('{}')
    return folder


def names(folder):
    files = (path for path in folder.rglob('*') if path.is_file())
    return {path.relative_to(folder).as_posix() for path in files}


def submitted(course, student):
    return names(course.folder('submitted', student, LESSON))


def rows(course, came_in):
    return {row.path: (row.outcome, row.reason) for row in collect(course, came_in)}


def zipped(folder, at, *, within='', files=None):
    at.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(at, 'w') as box:
        for name in sorted(files or names(folder)):
            box.write(folder / name, f'{within}{name}')
    return at


def read(course, student):
    folder = course.folder('submitted', student, LESSON)
    packages = course.packages(LESSON)
    return read_submission(folder, student_id=student, assignment=LESSON, packages=packages)


def test_the_lesson_says_which_package_it_asks_for(course):
    assert course.packages(LESSON) == (PACKAGE,)


MOODLE = 'Ada Lovelace_1815_assignsubmission_file_'


def folder_of_a_student(work, came_in):
    shutil.copytree(work, came_in / 'ada' / LESSON)


def archive_of_a_student(work, came_in):
    zipped(work, came_in / 'ada.zip', within=f'{LESSON}/')


def tar_of_a_student(work, came_in):
    with tarfile.open(came_in / 'ada.tar.gz', 'w:gz') as box:
        box.add(work, LESSON)


def moodle_with_folders(work, came_in):
    shutil.copytree(work, came_in / MOODLE)


def moodle_with_a_zip_of_the_package(work, came_in):
    (came_in / MOODLE).mkdir()
    shutil.copy(work / NOTEBOOK, came_in / MOODLE)
    zipped(work / PACKAGE, came_in / MOODLE / f'{PACKAGE}.zip', within=f'{PACKAGE}/')


def moodle_with_a_zip_of_what_is_in_the_package(work, came_in):
    (came_in / MOODLE).mkdir()
    shutil.copy(work / NOTEBOOK, came_in / MOODLE)
    zipped(work / PACKAGE, came_in / MOODLE / f'{PACKAGE} (1).zip')


def moodle_with_a_zip_of_the_workspace(work, came_in):
    (came_in / MOODLE).mkdir()
    shutil.copy(work / NOTEBOOK, came_in / MOODLE)
    inside = f'ros_ws/src/{PACKAGE}/'
    zipped(work / PACKAGE, came_in / MOODLE / f'{PACKAGE}.zip', within=inside)


def canvas_with_two_uploads(work, came_in):
    shutil.copy(work / NOTEBOOK, came_in / f'ada_18151_21012_{NOTEBOOK}')
    zipped(work / PACKAGE, came_in / f'ada_18151_21013_{PACKAGE}-1.zip', within=f'{PACKAGE}/')


def exchange(work, came_in):
    shutil.copytree(work, came_in / f'ada+{LESSON}+2026-11-20 10:00:00.000000 UTC+secret')


@pytest.mark.parametrize(
    'pack',
    [
        *(folder_of_a_student, archive_of_a_student, tar_of_a_student, moodle_with_folders),
        *(moodle_with_a_zip_of_the_package, moodle_with_a_zip_of_what_is_in_the_package),
        *(moodle_with_a_zip_of_the_workspace, canvas_with_two_uploads, exchange),
    ],
)
def test_a_package_is_collected_with_its_notebook(course, work, came_in, pack):
    pack(work, came_in)
    said = rows(course, came_in)
    [student] = os.listdir(course.gradebook / 'submitted')
    assert submitted(course, student) - {'timestamp.txt'} == {NOTEBOOK, *FILES}
    assert [outcome for outcome, _ in said.values() if outcome != NEW] == []
    assert {*read(course, student).files} == FILES


@pytest.mark.starts
def test_colcon_in_a_workspace_with_the_course_runs_no_setup_py_that_was_handed_in(
    course, work, came_in, tmp_path
):
    ran = tmp_path / 'ran'
    (work / PACKAGE / 'setup.py').write_text(f'open({str(ran)!r}, "w")')
    (work / PACKAGE / 'package.xml').write_text('<package/>')  # so colcon reads no name in it
    folder_of_a_student(work, came_in)
    rows(course, came_in)
    assert f'{PACKAGE}/setup.py' in submitted(course, 'ada')
    built = bash(course.root, 'colcon build --packages-select own')
    assert 'Summary: 0 packages finished' in built.stdout, built.stdout
    assert not ran.exists()


def test_a_changed_file_of_a_package_makes_a_new_submission(course, work, came_in):
    folder_of_a_student(work, came_in)
    rows(course, came_in)
    path = f'ada/{LESSON}/{NOTEBOOK}'
    assert rows(course, came_in)[path][0] == KNOWN
    (came_in / 'ada' / LESSON / PACKAGE / 'setup.cfg').write_text('# mine')
    assert rows(course, came_in)[path][0] == AGAIN
    place = course.folder('submitted', 'ada', LESSON)
    assert (place / PACKAGE / 'setup.cfg').read_text() == '# mine'


def test_another_students_package_is_not_taken(course, work, came_in):
    zipped(work / PACKAGE, came_in / f'bob_18152_21013_{PACKAGE}.zip', within=f'{PACKAGE}/')
    shutil.copy(work / NOTEBOOK, came_in / f'ada_18151_21012_{NOTEBOOK}')
    said = rows(course, came_in)
    assert submitted(course, 'ada') == {NOTEBOOK}
    left = {path: reason for path, (outcome, reason) in said.items() if outcome == LEFT}
    assert len(left) == len(FILES)


def test_student_and_instructor_read_which_files_are_left_out(course, work, came_in):
    package = work / PACKAGE
    for name in ('build/a.py', '__pycache__/a.pyc', '.git/config', 'x<y>.py'):
        (package / name).parent.mkdir(exist_ok=True)
        (package / name).write_text('')
    folder_of_a_student(work, came_in)
    (came_in / 'ada' / LESSON / PACKAGE / 'shadow').symlink_to('/etc/shadow')
    said = rows(course, came_in)
    at = f'ada/{LESSON}/{PACKAGE}'
    assert said[f'{at}/build/a.py'][0] == UNUSED
    assert said[f'{at}/.git'][0] == UNUSED
    assert said[f'{at}/x<y>.py'][0] == LEFT
    assert said[f'{at}/shadow'] == (LEFT, 'a link: only files are taken')
    assert submitted(course, 'ada') == {NOTEBOOK, LEFT_OUT, *FILES}
    notes = ' '.join(read(course, 'ada').notes)
    for name in ('build/a.py', 'x<y>.py', 'shadow (a link'):
        assert name in notes
    assert rows(course, came_in)[f'ada/{LESSON}/{NOTEBOOK}'][0] == KNOWN


def test_a_package_with_too_many_files_is_left_out_and_the_notebook_is_kept(course, work, came_in):
    with zipfile.ZipFile(zipped(work, came_in / 'ada.zip'), 'a') as box:
        for number in range(4_000):
            box.writestr(f'{PACKAGE}/data/{number}', '')
    rows(course, came_in)
    assert submitted(course, 'ada') == {NOTEBOOK, LEFT_OUT}
    [note] = read(course, 'ada').notes
    assert f'it has 4,006 files, and at most {MAX_FILES} are taken' in note
    assert 'most are in data/' in note


def test_an_archive_cannot_place_files_outside_of_its_package(course, work, came_in):
    with zipfile.ZipFile(zipped(work, came_in / 'ada.zip'), 'a') as box:
        box.writestr(f'{PACKAGE}/../../../evil.py', 'x')
        box.writestr(f'/{PACKAGE}/evil.py', 'x')
        box.writestr(f'{PACKAGE}/setup.cfg/under_a_file', 'x')
        box.writestr(f'{PACKAGE}/inner.zip', zip_of('deep.py'))
        box.writestr(f'{PACKAGE}/setup.py', 'twice')
    said = rows(course, came_in)
    place = course.folder('submitted', 'ada', LESSON)
    assert submitted(course, 'ada') == (
        {NOTEBOOK, LEFT_OUT, f'{PACKAGE}/setup.cfg/under_a_file', *FILES}
        - {f'{PACKAGE}/setup.cfg'}
    )
    assert (place / PACKAGE / 'setup.py').read_text() == 'twice'
    reasons = ' '.join(reason for outcome, reason in said.values() if outcome == LEFT)
    for words in ('leads out', 'absolute', 'a folder has the same name', 'in an archive', 'twice'):
        assert words in reasons


def zip_of(name):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, 'w') as box:
        box.writestr(name, 'x')
    return packed.getvalue()


def test_a_notebook_inside_a_package_is_not_taken_for_a_submission(course, work, came_in):
    shutil.copy(work / NOTEBOOK, work / PACKAGE / NOTEBOOK)
    folder_of_a_student(work, came_in)
    rows(course, came_in)
    assert submitted(course, 'ada') == {NOTEBOOK, f'{PACKAGE}/{NOTEBOOK}', *FILES}


def test_a_package_without_a_notebook_is_left_to_the_instructor(course, work, came_in):
    zipped(work / PACKAGE, came_in / 'ada' / f'{PACKAGE}.zip', within=f'{PACKAGE}/')
    said = rows(course, came_in)
    assert len(said) == len(FILES)
    assert {outcome for outcome, _ in said.values()} <= {LEFT, UNUSED}


def test_a_forged_note_is_shortened_and_has_no_control_characters(course, work):
    place = course.folder('submitted', 'ada', LESSON)
    shutil.copytree(work, place)
    (place / LEFT_OUT).write_bytes(b'\x1b[2J' + b'x' * 20_000)
    [note] = read(course, 'ada').notes
    assert len(note) == 300
    assert note.isprintable()
