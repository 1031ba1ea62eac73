"""The gradebook in a real server of PostgreSQL: the same scores as in SQLite, whatever ends it."""

import csv
import functools
import multiprocessing
import os
import random
import shutil
import subprocess
import sys
import threading
from collections import defaultdict
from pathlib import Path

import psycopg
import pytest
import survivor
from course_maker import TOY, answered, released_course, submit
from postgresql_server import PASSWORD, Server, use
from sample_class import FOLDER, hand_in

from grader.__main__ import main
from grader.common.errors import GradebookError
from grader.course import ROOT, Course
from grader.storage import failures
from grader.storage.backups import back_up
from grader.storage.database import in_sentences, make_database, transaction, wait_until_free
from grader.storage.records import records
from grader.storage.registering import register

pytestmark = [pytest.mark.slow, pytest.mark.starts]

GRADES = """
    SELECT s.student_id, c.name, g.auto_score, g.manual_score, g.needs_manual_grade
    FROM grade g JOIN base_cell c ON c.id = g.cell_id
        JOIN submitted_notebook n ON n.id = g.notebook_id
        JOIN submitted_assignment s ON s.id = n.assignment_id"""
KILLS = 12
NAMES = sorted(path.stem for path in FOLDER.glob('*.ipynb'))


@pytest.fixture(scope='module')
def server():
    server = Server()
    yield server
    server.end()


@pytest.fixture(scope='module')
def number():
    return iter(range(1000))


@pytest.fixture
def url(server, number):
    """Return the address of a new and empty database."""
    return server.make(f'course_{next(number)}')


@pytest.fixture
def course(tmp_path, url):
    """A course with one released lesson, whose gradebook is in PostgreSQL."""
    course = released_course(tmp_path / 'course')
    course.database.unlink()
    use(course.gradebook, url)
    return course


@pytest.fixture(scope='module')
def handed_in(tmp_path_factory):
    """A class that nobody has graded."""
    course = released_course(tmp_path_factory.mktemp('class'))
    for student, factor in (('ada', 2), ('bob', 3), ('zoe', 2), ('李雷', 2)):
        text = f'# {student}\ndef double(x):\n    return {factor} * x'
        submit(course, student, answered(course, text))
    course.seed(TOY, 'ada')
    return course


@pytest.fixture
def grade(tmp_path):
    """Grades in a process of its own, without rooms; returns status, calls, and what it said."""
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


def in_gradebook(handed_in, gradebook, url=None):
    shutil.copytree(handed_in.gradebook, gradebook)
    if url:
        (gradebook / 'gradebook.db').unlink()
        use(gradebook, url)
    return Course(root=handed_in.root, gradebook=gradebook)


def autograded(course):
    kept = course.folder('autograded', '', '')
    return {str(p.relative_to(kept)): p.read_bytes() for p in kept.rglob('*') if p.is_file()}


def nbgrader(course, *arguments):
    return subprocess.run(
        [sys.executable, '-m', 'nbgrader', *arguments],
        cwd=course.root,
        capture_output=True,
        text=True,
        check=False,
    )


def students_in(course):
    with transaction(course.db_url) as book:
        return [student.id for student in book.students]


def without_words(table):
    """Return a table's rows without the comments: checks say what they measured."""
    with table.open(encoding='utf-8-sig') as file:
        return [{k: v for k, v in row.items() if k != 'comment'} for row in csv.DictReader(file)]


@pytest.mark.isolation
@pytest.mark.timeout(3600)
def test_the_sample_class_gets_the_same_scores_check_by_check(tmp_path, url, capsys):
    found = []
    for name in ('sqlite', 'postgresql'):
        course = Course(root=ROOT, gradebook=tmp_path / name)
        if name == 'postgresql':
            use(course.gradebook, url)
        (course.gradebook / 'submitted').mkdir(parents=True)
        (course.gradebook / 'course_secret').write_text('ab' * 32)
        hand_in(course, NAMES)
        assert main(['grade'], course=course) == 0
        assert main(['scores'], course=course) == main(['scores', '--totals'], course=course) == 0
        assert main(['feedback'], course=course) == 0
        pages = {p.relative_to(course.gradebook) for p in course.gradebook.rglob('*.html')}
        tables = [without_words(course.gradebook / f'{each}.csv') for each in ('scores', 'totals')]
        feedback = {page for page in pages if page.parts[0] == 'feedback'}
        found.append((records(course), tables, feedback))
    assert not course.database.exists()
    assert found[0] == found[1]
    scored = {record.student_id for record in found[0][0] if record.score is not None}
    assert scored == {*NAMES}
    assert PASSWORD not in ''.join(capsys.readouterr())


@pytest.mark.timeout(3600)
def test_a_server_that_crashes_in_the_middle_loses_nothing_and_the_run_goes_on(
    handed_in, grade, server, number, tmp_path
):
    def fresh():
        at = next(number)
        return in_gradebook(handed_in, tmp_path / f'g{at}', server.make(f'course_{at}'))

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
    crash = functools.partial(crashed, server.programs, server.data, server.who)
    ended = []
    for kill in range(KILLS):
        course = fresh()
        part = survivor.PARTS[kill % len(survivor.PARTS)]
        strike_at = max(1, int(chance.random() * calls[part]))
        status, _, said = grade(course, crash, strike_at, part)
        ended.append(status)
        assert 'Traceback' not in said, said
        assert PASSWORD not in said
        assert 'not graded' not in said  # nobody is given up
        assert status == 0 or 'does not answer' in said, said
        assert status == 0 or 'run the same command again: it goes on' in said, said
        server.start()
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


def test_a_server_that_is_started_again_meanwhile_is_waited_for(course, server):
    register(course, TOY)
    server.stop()
    said = []

    def say(line):
        said.append(line)
        threading.Thread(target=server.start).start()

    wait_until_free(course, say)
    assert len(said) == 1
    assert said[0].startswith('waiting: postgresql://grader@127.0.0.1:')
    assert PASSWORD not in said[0]
    wait_until_free(course, said.append)
    assert len(said) == 1


def test_waiting_ends_and_what_waiting_does_not_help_is_told_at_once(course, server, monkeypatch):
    monkeypatch.setattr('grader.storage.failures.TIMEOUT_SEC', 0.3)
    server.stop()
    said = []
    with pytest.raises(GradebookError, match='does not answer'), in_sentences(course):
        wait_until_free(course, said.append)
    server.start()
    assert len(said) == 1
    monkeypatch.setattr('grader.storage.failures.TIMEOUT_SEC', 1e6)
    use(course.gradebook, server.address('no_such'))
    with pytest.raises(GradebookError, match='createdb'), in_sentences(course):
        wait_until_free(course, pytest.fail)


VERBS = (['grade'], ['scores'], ['scores', '--totals'], ['feedback'], ['release'])


def away(server, course):
    server.stop()


def wrong_password(server, course):
    name = course.db_url.partition('?')[0].rpartition('/')[2]
    use(course.gradebook, server.address(name, password=f'not-{PASSWORD}'))


def no_database(server, course):
    use(course.gradebook, server.address('no_such'))


def not_its_owner(server, course):
    use(course.gradebook, server.make(f'theirs_{os.getpid()}', owner='administrator'))


def another_encoding(server, course):
    use(course.gradebook, server.make(f'latin_{os.getpid()}', encoding='LATIN1'))


@pytest.mark.parametrize(
    ('fault', 'words'),
    [
        (away, 'does not answer (Connection refused)'),
        (wrong_password, 'refuses the login (password authentication failed'),
        (no_database, 'does not exist on that server. Make one'),
        (not_its_owner, 'OWNER TO USER'),
        (another_encoding, 'has the encoding LATIN1'),
    ],
)
def test_what_is_wrong_is_told_in_a_sentence_by_each_verb(course, server, fault, words, capfd):
    submit(course, 'ada', answered(course, 'def double(x):\n    return 2 * x'))
    fault(server, course)
    try:
        told = {}
        for verb in VERBS:
            status = main(verb, course=course)
            told[' '.join(verb)] = status, capfd.readouterr().err
        run = nbgrader(course, 'export', '--to', 'scores.csv')
        told['nbgrader export'] = run.returncode, run.stderr
    finally:
        if fault is away:
            server.start()
    for verb, (status, said) in told.items():
        if fault in (not_its_owner, another_encoding) and verb in ('release', 'feedback'):
            continue  # they find nothing in it yet, and write nothing into it
        assert status == 1, verb
        assert words in said, (verb, said)
        assert 'Traceback' not in said, (verb, said)
        assert PASSWORD not in said, verb


def test_the_tables_are_those_of_sqlite_and_made_by_one_of_several(course, tmp_path, server):
    started = [threading.Thread(target=make_database, args=[course]) for _ in range(4)]
    for each in started:
        each.start()
    for each in started:
        each.join()
    assert students_in(course) == []
    sqlite = Course.at(tmp_path / 'sqlite')
    make_database(sqlite)
    theirs = tables(sqlite)
    assert tables(course) == theirs
    assert len(theirs) > 10


def tables(course):
    from sqlalchemy import create_engine, inspect, text

    engine = create_engine(course.db_url)
    look = inspect(engine)
    found = {name: {c['name'] for c in look.get_columns(name)} for name in look.get_table_names()}
    with engine.connect() as connection:
        for name in ('alembic_version', 'course'):
            found[f'rows of {name}'] = connection.execute(text(f'SELECT * FROM {name}')).all()
    engine.dispose()
    return found


def test_a_database_is_made_whole_or_not_at_all(course, monkeypatch):
    class Killed(BaseException):
        pass

    def killed(*_, **__):
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr('alembic.script.ScriptDirectory', killed)  # tables are made by then
        with pytest.raises(Killed):
            make_database(course)
    assert tables_named(course) == []
    make_database(course)
    assert students_in(course) == []


def tables_named(course):
    from sqlalchemy import create_engine, inspect

    engine = create_engine(course.db_url)
    try:
        return inspect(engine).get_table_names()
    finally:
        engine.dispose()


def test_a_dump_is_made_once_for_each_state_and_brings_it_back(course, server, url, tmp_path):
    assert back_up(course) is None  # there is nothing yet
    register(course, TOY)
    with transaction(course.db_url) as book:
        book.update_or_create_student('ada')
    first = back_up(course)
    assert first.suffix == '.dump'
    assert back_up(course) == first
    with transaction(course.db_url) as book:
        book.update_or_create_student('bob')
    second = back_up(course)
    assert sorted(first.parent.iterdir()) == [first, second]
    restore = ['pg_restore', '--clean', '--if-exists', '--single-transaction', f'--dbname={url}']
    subprocess.run([server.programs / restore[0], *restore[1:], first], check=True)
    assert students_in(course) == ['ada']
    assert not register(course, TOY)
    assert back_up(course) not in (first, second)


def test_without_pg_dump_the_run_goes_on_and_says_so(course, monkeypatch, tmp_path, capsys):
    register(course, TOY)
    monkeypatch.setenv('PATH', str(tmp_path))
    assert back_up(course) is None
    said = capsys.readouterr().err
    assert said.startswith('No backup of the database is made: there is no pg_dump here')
    (tmp_path / 'pg_dump').write_text('#!/bin/sh\necho "$@" >&2; env >&2; exit 1\n')
    (tmp_path / 'pg_dump').chmod(0o755)
    monkeypatch.setenv('PATH', f'{tmp_path}{os.pathsep}/bin')
    assert back_up(course) is None
    said = capsys.readouterr().err
    assert 'PGPASSWORD=***' in said
    assert 'dbname=course_' in said
    assert PASSWORD not in said
    assert list((course.gradebook / 'backups').iterdir()) == []


@pytest.mark.isolation
def test_nbgraders_own_commands_and_its_formgrader_use_it(course):
    submit(course, 'ada', answered(course, 'def double(x):\n    return 2 * x', explained='so'))
    submit(course, 'bob', answered(course, 'def double(x):\n    return 3 * x'))
    for command in (['autograde', TOY], ['generate_feedback', TOY], ['export', '--to', 't.csv']):
        done = nbgrader(course, *command)
        assert done.returncode == 0, done.stderr
        assert 'Traceback' not in done.stderr
        assert PASSWORD not in done.stderr + done.stdout
    assert not course.database.exists()
    with (course.root / 't.csv').open() as file:
        totals = {row['student_id']: float(row['score']) for row in csv.DictReader(file)}
    assert totals == {'ada': 3.0, 'bob': 0.0}
    before = records(course)
    assert main(['grade', '--force'], course=course) == 0
    assert records(course) == before
    look = (
        'from nbgrader.apps import NbGrader\n'
        'from nbgrader.apps.api import NbGraderAPI\n'
        'app = NbGrader()\n'
        'app.initialize([])\n'
        'api = NbGraderAPI(app.coursedir, parent=app)\n'
        f'toy = api.get_assignment({TOY!r})\n'
        'ada, = [each for each in api.get_students() if each["id"] == "ada"]\n'
        f'print(toy["num_submissions"], toy["average_code_score"], ada["score"],\n'
        f'      len(api.get_submissions({TOY!r})), len(api.get_notebooks({TOY!r})),\n'
        f'      len(api.get_notebook_submissions({TOY!r}, {TOY!r})),\n'
        '      len(api.get_student_submissions("ada")),\n'
        f'      len(api.get_student_notebook_submissions("ada", {TOY!r})))\n'
    )
    done = subprocess.run(
        [sys.executable, '-c', look], cwd=course.root, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ['2', '1.5', '3.0', '2', '1', '2', '1', '1']
