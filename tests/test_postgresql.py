"""The gradebook in a real server of PostgreSQL: the same tables and scores as in SQLite."""

import csv
import subprocess
import sys
import threading

import pytest
from course_maker import TOY, answered, submit
from postgresql_server import PASSWORD, nbgrader, released_in, students_in, use
from sample_class import FOLDER, hand_in

from grader.__main__ import main
from grader.course import ROOT, Course
from grader.storage.database import make_database
from grader.storage.records import records

pytestmark = [pytest.mark.slow, pytest.mark.starts]

NAMES = sorted(path.stem for path in FOLDER.glob('*.ipynb'))


@pytest.fixture
def url(postgresql):
    return postgresql.fresh()


@pytest.fixture
def course(tmp_path, postgresql):
    return released_in(postgresql, tmp_path / 'course')


def without_words(table):
    """Return a table's rows without the comments: checks say what they measured."""
    with table.open(encoding='utf-8-sig') as file:
        return [{k: v for k, v in row.items() if k != 'comment'} for row in csv.DictReader(file)]


@pytest.mark.isolation
@pytest.mark.timeout(3600)
def test_the_sample_class_receives_the_same_scores_as_in_sqlite(tmp_path, url, capsys):
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


def test_the_tables_equal_those_of_sqlite_if_several_threads_make_them(
    course, tmp_path, postgresql
):
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


@pytest.mark.isolation
def test_nbgraders_commands_and_formgrader_use_the_postgresql_gradebook(course):
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
