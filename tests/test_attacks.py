"""Attacks on the grader among honest students: none gains points, leaks, persists or harms.

`attacks/answers/` holds a file for each attack that is an answer, `attacks/notebooks.py` those
that are something else. The first line of each attack says what it tries, and what it earns, if
anything.
"""

import ast
import csv
import inspect
import os
import re
import socket
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import nbformat
import psutil
import pytest
from answered import read
from attacks.corpus import (
    ANSWERS,
    CANARY,
    FOLDER,
    FULL,
    LEFT,
    NAMES,
    OTHERS,
    ROBOT,
    add_robot_lessons,
    assignment_of,
    attack,
    earns,
    hand_in_honestly,
    source_of,
)
from course_maker import TOY, released_course
from my_robot_basics.validate.lessons.names import names_of

from grader.course import Course
from grader.export.scores import write_scores
from grader.grade import grade_all
from grader.notebook.restore import KEY
from grader.report.feedback import write_feedback
from grader.storage.records import verdicts
from grader.storage.submitted import find_submissions
from grader.workers.workers import Workers

pytestmark = pytest.mark.isolation

EVERY = 5
"""There is one honest student for this number of attacks."""
BRIEF = (sys.executable, str(FOLDER.with_name('brief_worker.py')))


@dataclass
class Class:
    """What came of a class of attackers and honest students."""

    rows: dict
    course: Course
    pages: dict[str, str]
    scores: str
    knocks: int
    """How many of the machine's own servers got a connection."""


def grade_class(root, names, backend):
    """Grade attacks, several at a time, honest students in between."""
    course = released_course(root)
    add_robot_lessons(course)
    course.gradebook.mkdir(exist_ok=True)
    with (
        socket.create_server(('127.0.0.1', 0)) as server,
        socket.socket(socket.AF_UNIX) as local,
    ):
        local.bind(str(course.gradebook / 'socket'))
        local.listen()
        for number, name in enumerate(names):
            attack(course, name, port=server.getsockname()[1])
            if number % EVERY == 0:
                hand_in_honestly(course, f'honest-{name}')
        hand_in_honestly(course, 'honest-robot', ROBOT)
        submissions = sorted(find_submissions(course), key=lambda each: order(each.student_id))
        rows = {row.student_id: row for row in grade_all(course, submissions, backend=backend)}
        knocks = sum(knocked(each) for each in (server, local))
    pages = {page.parts[-3]: page.read_text(encoding='utf-8') for page in write_feedback(course)}
    return Class(rows, course, pages, write_scores(course).read_text(encoding='utf-8-sig'), knocks)


def knocked(server):
    server.setblocking(False)
    try:
        server.accept()[0].close()
    except BlockingIOError:
        return False
    return True


def order(student):
    """An honest student comes right after the attack that it is named after."""
    return student.removeprefix('honest-'), student.startswith('honest-')


@pytest.fixture(scope='module')
def graded(request, tmp_path_factory):
    """Grade those attacks that this run takes: an ordinary one leaves some to --slow."""
    here = (item for item in request.session.items if item.path == request.path)
    asked = {item.callspec.params.get('name') for item in here if hasattr(item, 'callspec')}
    names = [name for name in NAMES if name in asked] or NAMES
    for name in LEFT:
        Path('/tmp', name).unlink(missing_ok=True)
    backend = Workers(in_flight=6, command=BRIEF)
    return grade_class(tmp_path_factory.mktemp('attacked'), names, backend)


def test_each_attack_describes_what_it_tries():
    for path in ANSWERS.values():
        assert ast.get_docstring(ast.parse(path.read_text(encoding='utf-8'))).endswith('.')
    assert all(inspect.getdoc(function) for function in OTHERS.values())
    assert len(NAMES) >= 40


def test_each_name_that_an_attack_uses_is_defined():
    """An attack that stops at a NameError would earn nothing only because it tries nothing."""
    missing = {}
    for name in ANSWERS:
        bound = {'PORT', 'GRADEBOOK'}
        if (lesson := assignment_of(name)) != TOY:
            cells = [cell for cell in read('notebooks', lesson).cells if cell.cell_type == 'code']
            bound = bound.union(*(names_of(cell.source).bound for cell in cells))
        missing[name] = names_of(source_of(name)).needed - bound
    assert {name: names for name, names in missing.items() if names} == {}


@pytest.mark.timeout(900)
@pytest.mark.parametrize('name', NAMES)
def test_an_attack_earns_only_the_points_of_its_honest_work(graded, name):
    stored = graded.rows[name].stored
    assert stored is not None, graded.rows[name].reason
    said = verdicts(graded.course, name, assignment_of(name))
    outcomes = {v.outcome for v in said.values() if 'outcome' in v}
    assert outcomes <= {'passed', 'failed'}, graded.rows[name].reason
    assert stored.score == earns(name), said
    assert stored.score >= FULL[assignment_of(name)] or graded.rows[name].reason


@pytest.mark.parametrize('name', NAMES)
def test_an_attack_reveals_neither_hidden_tests_nor_the_seed(graded, name):
    assert CANARY not in graded.pages[name]
    (path,) = graded.course.folder('autograded', name, '').glob('*/*.ipynb')
    cells = nbformat.read(path, as_version=4).cells
    told = str([(c.get('outputs'), c.metadata.get(KEY), c.get('attachments')) for c in cells])
    assert CANARY not in told
    assert graded.course.seed(TOY, name) not in told + graded.pages[name]


def test_honest_students_get_full_points_beside_attacks(graded):
    theirs = {n: row.stored.score for n, row in graded.rows.items() if n.startswith('honest-')}
    assert len(theirs) > (len(graded.rows) - len(theirs)) // EVERY
    assert theirs == {n: FULL[ROBOT if n == 'honest-robot' else TOY] for n in theirs}


def test_exported_scores_stay_within_their_maximum_and_leak_nothing(graded):
    assert CANARY not in graded.scores
    rows = list(csv.DictReader(graded.scores.splitlines()))
    assert {float(row['max_score']) for row in rows} == {1.0, 2.0, 3.0}
    assert [r for r in rows if r['score'] and float(r['score']) > float(r['max_score'])] == []


def test_attacks_leave_no_file_process_or_connection(graded):
    assert graded.knocks == 0
    assert [name for name in LEFT if Path('/tmp', name).exists()] == []
    left = [p for p in psutil.process_iter(['cmdline']) if '86421' in (p.info['cmdline'] or ())]
    assert left == []


@pytest.mark.parametrize('name', ['html_and_escapes'])
def test_html_of_an_attack_is_escaped_in_the_feedback(graded, name):
    page = graded.pages[name]
    assert 'alert' in page  # it is shown, as text
    assert re.findall(r'<script|<img src=x|<svg[^>]*>.*alert|\x1b|\u202e', page) == []


def test_some_attacks_succeed_without_a_sandbox(tmp_path):
    """Some attacks, run without a sandbox on files that they may have: each does what it says."""
    stolen = tmp_path / 'left.txt'
    stolen.write_text(CANARY)
    code = (
        (FOLDER / 'reads_the_tests_from_disk.py').read_text().replace("'/'", repr(str(tmp_path)))
    )
    assert CANARY in run(code)
    with socket.create_server(('127.0.0.1', 0)) as server:
        code = (
            (FOLDER / 'network_out.py').read_text().replace('PORT', str(server.getsockname()[1]))
        )
        assert '127.0.0.1' in run(code)
    assert 'seed-of-the-course' in run(
        (FOLDER / 'reads_the_seed.py').read_text(), MY_ROBOT_BASICS_SEED='seed-of-the-course'
    )


def run(code, **environment):
    done = subprocess.run(
        [sys.executable, '-c', f'{code}\nprint(double(1))'],
        capture_output=True,
        text=True,
        env=os.environ | environment,
    )
    return done.stdout


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize('repetition', range(5))
def test_repeated_grading_with_the_usual_time_limits_gives_the_same_scores(
    tmp_path, graded, repetition
):
    again = grade_class(tmp_path, NAMES, Workers(in_flight=8))
    assert scores(again) == scores(graded)


def scores(graded):
    return {name: row.stored and row.stored.score for name, row in graded.rows.items()}
