"""This course's own bundle, unpacked as by a student: its README, its verbs, a fresh machine."""

import json
import re
import shutil
import socket
import subprocess
import time
import urllib.request

import pytest
from fresh_machine import fresh_environment
from unpacking import unpacked

from grader.authoring.bundle import bundle
from grader.course import ROOT, Course
from launcher import lab, languages

BEHIND_THEM = {'launcher', 'locale'}
"""Folders of the bundle that no student opens."""


@pytest.fixture(scope='module')
def students(tmp_path_factory):
    """The real bundle, unpacked; test_release.py tests that its lessons are up to date."""
    folder = tmp_path_factory.mktemp('a student')
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr('grader.authoring.bundle.stale_or_leaking', lambda course: [])
        bundle(Course(), folder / 'students.zip')
    return unpacked(folder / 'students.zip', folder)


def test_the_readme_of_the_bundle_matches_its_verbs_and_folders(students):
    readme = (students / 'README.md').read_text()
    usage = subprocess.run([students / 'course', '--help'], capture_output=True, text=True)
    assert usage.returncode == 0
    verbs = set(re.findall(r'^  ([\w-]+)', usage.stdout, re.MULTILINE))
    assert (
        verbs - {'hub'}  # that a hub starts, and nobody types
        == set(re.findall(r'\./course (\w[\w-]*)', readme))
        == {'lab', 'validate', 'progress', 'workspace', 'ros-shell', 'wheels'}
    )
    rows = readme.partition('## What is where')[2]
    named = re.findall(r'`([^`]+)`', ' '.join(re.findall(r'^\| (`.+?) \|', rows, re.MULTILINE)))
    assert [name for name in named if not (students / name).exists()] == []
    folders = {path.name for path in students.iterdir() if path.is_dir() and path.name[0] != '.'}
    assert {name.strip('/') for name in named} == folders - BEHIND_THEM | {
        'course',
        'environment.txt',
    }
    for text in (readme, (ROOT / 'README.md').read_text(encoding='utf-8')):
        assert 'a minute or two' in ' '.join(text.split())
    assert (students / 'notebooks/02_joint_state/02_joint_state.ipynb').is_file()


def test_files_that_lab_needs_are_in_the_bundle(students):
    assert (students / 'notebooks/index.ipynb').is_file()
    assert (students / languages.SETTINGS).is_dir()
    assert (students / lab.TERMINAL).is_file()


def test_a_verb_that_needs_the_grader_is_refused_as_for_instructors(students):
    run = subprocess.run([students / 'course', 'grade'], capture_output=True, text=True)
    assert run.returncode == 1
    assert "'grade' is for instructors" in run.stderr


@pytest.fixture
def fresh(students, tmp_path):
    """What a fresh machine has: no .venv, no settings, and nothing of this one's environment."""
    yield fresh_environment(tmp_path)
    shutil.rmtree(students / '.venv', ignore_errors=True)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_lab_serves_the_lessons_and_the_tools_run_on_a_fresh_machine(students, fresh, tmp_path):
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    options = ['--no-browser', f'--port={port}', '--ServerApp.port_retries=0']
    log = (tmp_path / 'log').open('w+')
    lab = subprocess.Popen(
        [students / 'course', 'lab', *options, '--IdentityProvider.token=let-me-in'],
        env=fresh,
        stdout=log,
        stderr=log,
    )
    try:
        address = f'http://127.0.0.1:{port}'
        listing = json.loads(_fetched(f'{address}/api/contents?token=let-me-in', lab))
        served = {each['name'] for each in listing['content']}
        assert {'index.ipynb', '02_joint_state', '07_common_errors'} <= served
        page = _fetched(f'{address}/lab/tree/index.ipynb?token=let-me-in', lab).decode()
        assert '@jupyter/nbgrader:formgrader' in page.partition('disabledExtensions')[2]
    except AssertionError:
        log.seek(0)
        print(log.read())
        raise
    finally:
        lab.terminate()
        lab.wait(30)
    asked = (
        'ros2 pkg executables my_robot_basics; topic_doctor --help | head -1;'
        'python -c "import my_robot_basics; print(my_robot_basics.__file__)"'
    )
    run = subprocess.run(
        [students / 'course', 'ros-shell', '-c', asked], env=fresh, capture_output=True, text=True
    )
    *nodes, doctor, where = run.stdout.splitlines()
    assert [line.split()[1] for line in nodes] == [
        'hello_node',
        'kinematics_node',
        'kinematics_publisher',
        'kinematics_subscriber',
    ], run.stderr
    assert doctor.startswith('usage: topic_doctor')
    assert where.startswith(str(students))
    # a lesson's set-up cells and its checks find all that they import
    program = 'import my_robot_basics.checks, my_robot_basics.live, nbgrader.validator'
    subprocess.run([students / '.venv/bin/python', '-c', program], env=fresh, check=True)


def _fetched(address, server):
    """Return what the server has at this address, once it answers."""
    while server.poll() is None:
        try:
            with urllib.request.urlopen(address, timeout=30) as answer:
                return answer.read()
        except OSError:
            time.sleep(0.5)
    raise AssertionError(f'./course lab ended with status {server.returncode}')
