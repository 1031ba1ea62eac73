"""A server of PostgreSQL that ends or does not answer: no grade is lost, no fault hidden."""

import functools
import itertools
import multiprocessing
import os
import random
import shutil
import subprocess
import threading
from collections import defaultdict
from pathlib import Path

import psycopg
import pytest
import survivor
from course_maker import TOY, answered, released_course, submit
from postgresql_server import PASSWORD, USER, nbgrader, released_in, use

from grader.__main__ import main
from grader.common.errors import GradebookError
from grader.course import Course
from grader.storage import failures
from grader.storage.database import raise_gradebook_errors, wait_until_free
from grader.storage.postgresql import make_tables
from grader.storage.records import records
from grader.storage.registering import register

pytestmark = [pytest.mark.slow, pytest.mark.starts]

GRADES = """
    SELECT s.student_id, c.name, g.auto_score, g.manual_score, g.needs_manual_grade
    FROM grade g JOIN base_cell c ON c.id = g.cell_id
        JOIN submitted_notebook n ON n.id = g.notebook_id
        JOIN submitted_assignment s ON s.id = n.assignment_id"""
KILLS = 12


@pytest.fixture
def course(tmp_path, postgresql):
    return released_in(postgresql, tmp_path / 'course')


@pytest.fixture(scope='module')
def handed_in(tmp_path_factory):
    """A class that is not graded yet."""
    course = released_course(tmp_path_factory.mktemp('class'))
    for student, factor in (('ada', 2), ('bob', 3), ('zoe', 2), ('李雷', 2)):
        text = f'# {student}\ndef double(x):\n    return {factor} * x'
        submit(course, student, answered(course, text))
    course.seed(TOY, 'ada')
    return course


@pytest.fixture
def grade(tmp_path):
    """Grades in a process of its own, without rooms; returns status, calls and output."""
    context = multiprocessing.get_context('forkserver')

    def grade_course(course, strike=None, strike_at=0, part='all'):
        log, said = tmp_path / 'log', tmp_path / 'said'
        log.write_text('')
        arguments = (str(course.root), str(course.gradebook), str(log), strike_at, part)
        more = (strike or survivor.kill, str(said))
        process = context.Process(target=survivor.run, args=arguments + more)
        process.start()
        process.join()
        assert process.exitcode == 0
        status, *calls = log.read_text().splitlines()[-1].split()
        return (
            int(status),
            dict(zip(survivor.PARTS, map(int, calls), strict=True)),
            said.read_text(),
        )

    return grade_course


def in_gradebook(handed_in, gradebook, url):
    shutil.copytree(handed_in.gradebook, gradebook)
    (gradebook / 'gradebook.db').unlink()
    use(gradebook, url)
    return Course(root=handed_in.root, gradebook=gradebook)


def autograded(course):
    kept = course.folder('autograded', '', '')
    return {str(p.relative_to(kept)): p.read_bytes() for p in kept.rglob('*') if p.is_file()}


@pytest.mark.timeout(3600)
def test_a_crash_of_the_server_loses_no_grade_and_the_next_run_goes_on(
    handed_in, grade, postgresql, tmp_path
):
    numbers = itertools.count()

    def fresh():
        return in_gradebook(handed_in, tmp_path / f'g{next(numbers)}', postgresql.fresh())

    def in_database(course):
        found = defaultdict(set)
        address = course.db_url.replace('+psycopg', '').partition('?')[0]
        with psycopg.connect(address) as connection:
            if connection.execute("SELECT to_regclass('grade')").fetchone() == (None,):
                return found  # it crashed before there were any tables
            for student, *its in connection.execute(GRADES):
                found[student].add(tuple(its))
        return found

    whole = fresh()
    status, calls, _ = grade(whole)
    assert status == 0
    wanted, rows, files = in_database(whole), records(whole), autograded(whole)
    assert {row.student_id for row in rows} == {'ada', 'bob', 'zoe', '李雷'}
    chance = random.Random(7)
    crash = functools.partial(crashed, postgresql.programs, postgresql.data, postgresql.who)
    ended = []
    for kill in range(KILLS):
        course = fresh()
        part = survivor.PARTS[kill % len(survivor.PARTS)]
        strike_at = max(1, int(chance.random() * calls[part]))
        status, _, said = grade(course, crash, strike_at, part)
        ended.append(status)
        assert 'Traceback' not in said, said
        assert PASSWORD not in said
        assert 'not graded' not in said  # no student is given up
        assert status == 0 or 'does not answer' in said, said
        assert status == 0 or 'run the same command again: it goes on' in said, said
        postgresql.start()
        for student, grades in in_database(course).items():
            assert grades == wanted[student]  # all of a submission, or none of it
        before = autograded(course)
        assert grade(course)[0] == 0
        assert (in_database(course), records(course)) == (wanted, rows)
        assert autograded(course) == files
        done = {name: text for name, text in before.items() if not name.endswith('.begun')}
        assert done.items() <= files.items()
    assert 1 in ended


def crashed(programs, data, who):
    """Stop the server as a crash does; called in the process of a run."""
    failures.TIMEOUT_SEC = 1.0
    stop = [programs / 'pg_ctl', 'stop', '-w', '-D', data, '-m', 'immediate']
    if not Path(data, 'postmaster.pid').exists():
        return
    subprocess.run(stop, cwd='/', check=True, stdout=subprocess.DEVNULL, **who)


def test_wait_until_free_waits_for_a_server_that_is_started_again(course, postgresql):
    register(course, TOY)
    postgresql.stop()
    said = []

    def say(line):
        said.append(line)
        threading.Thread(target=postgresql.start).start()

    wait_until_free(course, say)
    assert len(said) == 1
    assert said[0].startswith('waiting: postgresql://grader@127.0.0.1:')
    assert PASSWORD not in said[0]
    wait_until_free(course, said.append)
    assert len(said) == 1


def test_waiting_for_the_server_ends_and_is_skipped_for_other_faults(
    course, postgresql, monkeypatch
):
    monkeypatch.setattr('grader.storage.failures.TIMEOUT_SEC', 0.3)
    postgresql.stop()
    said = []
    with pytest.raises(GradebookError, match='does not answer'), raise_gradebook_errors(course):
        wait_until_free(course, said.append)
    postgresql.start()
    assert len(said) == 1
    monkeypatch.setattr('grader.storage.failures.TIMEOUT_SEC', 1e6)
    use(course.gradebook, postgresql.address('no_such'))
    with pytest.raises(GradebookError, match='createdb'), raise_gradebook_errors(course):
        wait_until_free(course, pytest.fail)


VERBS = (['grade'], ['scores'], ['scores', '--totals'], ['feedback'], ['release'])


def away(postgresql, course):
    postgresql.stop()


def wrong_password(postgresql, course):
    name = course.db_url.partition('?')[0].rpartition('/')[2]
    use(course.gradebook, postgresql.address(name, password=f'not-{PASSWORD}'))


def no_database(postgresql, course):
    use(course.gradebook, postgresql.address('no_such'))


def not_its_owner(postgresql, course):
    use(course.gradebook, postgresql.make(f'theirs_{os.getpid()}', owner='administrator'))


def tables_of_another(postgresql, course):
    name = f'tables_{os.getpid()}'
    url = postgresql.make(name).replace(f'{USER}:', 'administrator:')
    make_tables(url.replace('postgresql:', 'postgresql+psycopg:'))
    use(course.gradebook, postgresql.address(name))


def another_encoding(postgresql, course):
    use(course.gradebook, postgresql.make(f'latin_{os.getpid()}', encoding='LATIN1'))


def full(postgresql, course):
    limit_connections(postgresql, 0)


def limit_connections(postgresql, most):
    with postgresql.administrator() as connection:
        connection.execute(f'ALTER ROLE {USER} CONNECTION LIMIT {most}')


@pytest.mark.parametrize(
    ('fault', 'words'),
    [
        (full, 'takes no more connections (too many connections for role'),
        (away, 'does not answer (Connection refused)'),
        (wrong_password, 'refuses the login (password authentication failed'),
        (no_database, 'does not exist on that server. Make one'),
        (not_its_owner, 'OWNER TO USER'),
        (tables_of_another, 'and its tables (docs/postgresql.md, Rights)'),
        (another_encoding, 'has the encoding LATIN1'),
    ],
)
def test_each_verb_reports_a_fault_of_the_server_in_a_sentence(
    course, postgresql, fault, words, capfd
):
    submit(course, 'ada', answered(course, 'def double(x):\n    return 2 * x'))
    fault(postgresql, course)
    try:
        told = {}
        for verb in VERBS:
            status = main(verb, course=course)
            told[' '.join(verb)] = status, capfd.readouterr().err
        run = nbgrader(course, 'export', '--to', 'scores.csv')
        told['nbgrader export'] = run.returncode, run.stderr
    finally:
        if fault is away:
            postgresql.start()
        if fault is full:
            limit_connections(postgresql, -1)
    for verb, (status, said) in told.items():
        if fault in (not_its_owner, another_encoding) and verb in ('release', 'feedback'):
            continue  # they find nothing in it yet, and write nothing into it
        assert status == 1, verb
        assert words in said, (verb, said)
        assert 'Traceback' not in said, (verb, said)
        assert PASSWORD not in said, verb
