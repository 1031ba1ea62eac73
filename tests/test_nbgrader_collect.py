"""`nbgrader collect`, and the formgrader's button, take in what `./course collect` does."""

import os
import pwd
import shutil

import nbformat
import pytest
from course_maker import TOY, answered, released_course
from nbgrader_command import run_nbgrader

AT = '2026-11-20 10:00:00.000000 UTC'
SECRET = 'what only instructors may read'


needs_root = pytest.mark.skipif(os.geteuid() != 0, reason='only root gives files to others')
pytestmark = pytest.mark.starts
DAEMON = pwd.getpwnam('daemon')[2:4]


@pytest.fixture
def course(tmp_path):
    return released_course(tmp_path / 'course')


@pytest.fixture
def inbound(course, tmp_path):
    """The folder of nbgrader's exchange into which three students have put something."""
    folder = tmp_path / 'exchange/robots/inbound'
    folder.mkdir(parents=True)
    work = answered(course, 'def double(x):\n    return x + x')
    for name in (f'ada+{TOY}+{AT}+a', f'eve+{TOY}+{AT}+b', f'mallory+{TOY}+{AT}+c'):
        (folder / name).mkdir()
        nbformat.write(work, folder / name / f'{TOY}.ipynb')
    return folder


def nbgrader_collect(course, inbound):
    return run_nbgrader('collect', TOY, course=course, exchange=inbound.parents[1])


def submitted(course):
    return course.gradebook / 'submitted'


def test_a_link_in_a_submission_is_not_followed(course, inbound, tmp_path):
    (tmp_path / 'hidden_test.py').write_text(f'text = {SECRET!r}')
    leak = inbound / f'eve+{TOY}+{AT}+b' / 'leak.py'
    leak.symlink_to(tmp_path / 'hidden_test.py')
    done = nbgrader_collect(course, inbound)
    taken = [path for path in submitted(course).rglob('*') if path.is_file()]
    assert not [path.name for path in taken if SECRET in path.read_text()]
    assert done.returncode == 0, done.stdout
    assert 'a link: only files are taken' in done.stdout


def test_no_entry_ends_the_command(course, inbound):
    os.mkfifo(inbound / f'eve+{TOY}+{AT}+b' / 'waits.py')
    (inbound / f'zoe+{TOY}+when').mkdir()
    done = nbgrader_collect(course, inbound)
    assert done.returncode == 0, done.stdout
    assert sorted(os.listdir(submitted(course))) == ['ada', 'eve', 'mallory']


@needs_root
def test_nobodys_work_is_replaced_by_what_another_user_names_after_them(course, inbound):
    theirs = inbound / f'ada+{TOY}+2027-01-01 00:00:00.000000 UTC+d'
    shutil.copytree(inbound / f'eve+{TOY}+{AT}+b', theirs)
    for path in (theirs, *theirs.iterdir()):
        os.chown(path, *DAEMON)
    done = nbgrader_collect(course, inbound)
    assert 'it is named after ada, and the user daemon put it there' in done.stdout
    assert not done.returncode


def test_an_exchange_that_is_not_there_is_said_in_a_sentence(course, inbound):
    shutil.rmtree(inbound)
    done = nbgrader_collect(course, inbound)
    assert done.returncode != 0
    assert f'there is no folder {inbound}: name the course' in done.stdout
