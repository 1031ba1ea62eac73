"""Grading that is killed and started again loses nothing, and no result differs."""

import multiprocessing
import random
import shutil
import sqlite3
from collections import defaultdict
from contextlib import closing

import pytest
import survivor
from course_maker import TOY, answered, released_course, submit

from grader.course import Course
from grader.storage.records import records

RIGHT = '# {}\ndef double(x):\n    return 2 * x'
WRONG = '# {}\ndef double(x):\n    return x + 1'
GRADES = """
    SELECT s.student_id, c.name, g.auto_score, g.manual_score, g.needs_manual_grade
    FROM grade g JOIN base_cell c ON c.id = g.cell_id
        JOIN submitted_notebook n ON n.id = g.notebook_id
        JOIN submitted_assignment s ON s.id = n.assignment_id"""


@pytest.fixture(scope='module')
def start():
    """Starts a run in a process of its own, and waits for its end."""
    context = multiprocessing.get_context('forkserver')
    context.set_forkserver_preload(['grader.__main__'])

    def start_run(course, log, kill_at=0, part='all'):
        log.write_text('')
        arguments = (str(course.root), str(course.gradebook), str(log), kill_at, part)
        process = context.Process(target=survivor.run, args=arguments)
        process.start()
        process.join()
        lines = log.read_text(encoding='utf-8').splitlines()
        judged = {line.removeprefix('judged ') for line in lines if line.startswith('judged ')}
        return process.exitcode, judged, lines

    return start_run


@pytest.fixture(scope='module')
def handed_in(tmp_path_factory):
    """A class that is not graded yet; one student handed in more than a notebook."""
    course = released_course(tmp_path_factory.mktemp('survival'))
    for student, answer in (('ada', RIGHT), ('bob', WRONG), ('zoe', RIGHT)):
        notebook = submit(course, student, answered(course, answer.format(student)))
    notebook.with_name('helper.py').write_text('x = 1')
    notebook.with_name('timestamp.txt').write_text('2026-01-02 03:04:05 UTC')
    submit(course, 'eve', b'no notebook')
    course.seed(TOY, 'ada')
    return course


@pytest.fixture(scope='module')
def uninterrupted(handed_in, start, tmp_path_factory):
    """What an uninterrupted run has stored, and how many calls it took."""
    folder = tmp_path_factory.mktemp('uninterrupted')
    course = fresh(handed_in, folder / 'gradebook')
    code, judged, lines = start(course, folder / 'log')
    status, *calls = lines[-1].split()
    assert (code, status, judged) == (0, '0', {'ada', 'bob', 'zoe'})
    parts = dict(zip(survivor.PARTS, map(int, calls), strict=True))
    return stored(course), in_database(course), parts


def fresh(handed_in, gradebook):
    shutil.rmtree(gradebook, ignore_errors=True)
    shutil.copytree(handed_in.gradebook, gradebook)
    return Course(root=handed_in.root, gradebook=gradebook)


def stored(course):
    """Return all that the gradebook holds, after storing what a run began to store."""
    rows = records(course)
    with closing(sqlite3.connect(course.database)) as database:
        assert database.execute('PRAGMA integrity_check').fetchone() == ('ok',)
        times = database.execute('SELECT timestamp FROM submitted_assignment').fetchall()
    kept = course.folder('autograded', '', '')
    files = {str(p.relative_to(kept)): p.read_bytes() for p in kept.rglob('*') if p.is_file()}
    return rows, sorted(times, key=str), files


def done(course):
    """Return the students whose result is on the disk already."""
    return {
        path.parts[-3] for path in course.folder('autograded', '', '').glob(f'*/*/{TOY}.ipynb')
    }


def in_database(course):
    """Return each student's scores as another program finds them, even during a run."""
    found = defaultdict(set)
    if course.database.exists():
        with closing(sqlite3.connect(course.database)) as database:
            for student, *grade in database.execute(GRADES):
                found[student].add(tuple(grade))
    return found


def grade_with_kills(handed_in, uninterrupted, start, folder, *, kills):
    """Grade with so many kills at random moments of each part, and go on after each."""
    whole, wanted, calls = uninterrupted
    course, chance = fresh(handed_in, folder / 'gradebook'), random.Random(5)
    while kills:
        part = survivor.PARTS[kills % len(survivor.PARTS)]
        before, kill_at = done(course), max(1, int(chance.random() * calls[part]))
        code, judged, _ = start(course, folder / 'log', kill_at=kill_at, part=part)
        assert not judged & before
        for student, grades in in_database(course).items():
            assert grades == wanted[student]
        if code == 0:  # earlier runs had done so much that it ended before the kill
            assert stored(course) == whole
            course = fresh(handed_in, folder / 'gradebook')
        else:
            assert code == -9
            kills -= 1
    before = done(course)
    code, judged, lines = start(course, folder / 'log')
    assert (code, lines[-1].split()[0]) == (0, '0')
    assert not judged & before
    assert stored(course) == whole


@pytest.mark.slow
def test_a_run_killed_five_times_ends_with_the_results_of_an_undisturbed_run(
    handed_in, uninterrupted, start, tmp_path
):
    grade_with_kills(handed_in, uninterrupted, start, tmp_path, kills=5)


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_a_run_killed_fifty_times_ends_with_the_results_of_an_undisturbed_run(
    handed_in, uninterrupted, start, tmp_path
):
    grade_with_kills(handed_in, uninterrupted, start, tmp_path, kills=50)
