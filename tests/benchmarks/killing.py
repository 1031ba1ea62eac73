"""Compare a class whose grading was killed several times with one that was not disturbed.

Everything in the gradebook is compared: scores, manual scores and comments, due dates and late
penalties, the verdicts with their reasons, and the feedback pages. Numbers in reasons and pages
are ignored, because rates are measured, and so are pictures, because they show measured values.
"""

import re
import shutil
import sqlite3
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing

import psutil
from measuring import ROW, Course, course_command, kill_a_worker, new_course, table, watch
from nbgrader.api import Gradebook
from synthetic_class import Paper

from grader.collect.collect import collect
from grader.storage.gradebook import needs_manual_grade
from grader.storage.records import records, verdicts

MOST_SHOWN = 20
_TIMES_OF_RUNS = re.compile(r'(data:image/\w+;base64,)[\w+/=\s]+|-?\d+(\.\d+)?(e-?\d+)?')
_DATABASE = {
    'grade': """
        SELECT s.student_id, c.name, g.auto_score, g.manual_score, g.extra_credit,
            g.needs_manual_grade
        FROM grade g JOIN base_cell c ON c.id = g.cell_id
            JOIN submitted_notebook n ON n.id = g.notebook_id
            JOIN submitted_assignment s ON s.id = n.assignment_id""",
    'comment': """
        SELECT s.student_id, c.name, m.auto_comment, m.manual_comment
        FROM comment m JOIN base_cell c ON c.id = m.cell_id
            JOIN submitted_notebook n ON n.id = m.notebook_id
            JOIN submitted_assignment s ON s.id = n.assignment_id""",
    'handed in': """
        SELECT s.student_id, a.name, s.timestamp, s.extension, a.duedate,
            n.late_submission_penalty
        FROM submitted_notebook n JOIN submitted_assignment s ON s.id = n.assignment_id
            JOIN assignment a ON a.id = s.assignment_id""",
}


def killed(what: str, whole: Course, papers: Sequence[Paper], options: Sequence[str]) -> bool:
    """Grade the class once more, with kills; return whether the result differs."""
    course = new_course('killed')
    list(collect(course, whole.gradebook.with_name('class.zip')))
    # with the same secret, hidden tests choose the same inputs
    shutil.copy(whole.gradebook / 'course_secret', course.gradebook)
    moments = [max(1, len(papers) // 3), max(2, 2 * len(papers) // 3)]
    if what == 'run':
        runs = [*({moment: psutil.Process.kill} for moment in moments), {}]
    else:
        runs = [dict.fromkeys(moments, kill_a_worker)]
    rows, read = [], set()
    for meanwhile in runs:
        watched = watch(course_command(course, 'grade', *options), done=ROW, meanwhile=meanwhile)
        stored = len(list(course.gradebook.glob('autograded/*/*/*.ipynb')))
        unchanged = watched.said.count('(unchanged)')
        rows.append((watched.status, len(watched.done_at), unchanged, watched.seconds, stored))
        read = read_answers(course, but=read)
    read_answers(whole)
    print(f'\nWith the {what} killed in mid-class, twice; {len(read)} answers read by a person:')
    table(('exit', 'rows', 'unchanged', 'seconds', 'stored by then'), rows)
    for each in (whole, course):
        told = watch(course_command(each, 'feedback'), done=ROW)
        assert told.status == 0, told.said
    return differ(everything(whole), everything(course))


def read_answers(course: Course, but: set[str] = frozenset()) -> set[str]:
    """Give points and a comment for each answer that waits for manual grading.

    Skip students in `but`, whose answers were graded before. Return all students graded by hand.
    """
    given = set(but)
    with Gradebook(course.db_url) as book:
        submissions = [each for student in book.students for each in student.submissions]
        for notebook in (each for submission in submissions for each in submission.notebooks):
            student, assignment = notebook.student.id, notebook.assignment.assignment.name
            for grade in notebook.grades:
                if student in but or grade.cell_type == 'code' or not needs_manual_grade(grade):
                    continue
                points = (sum(student.encode()) % 5) / 4 * grade.max_score
                grade.manual_score, grade.needs_manual_grade = points, False
                comment = book.find_comment(grade.name, notebook.name, assignment, student)
                comment.manual_comment = f'{points:g}, {student}'
                given.add(student)
        book.db.commit()
    return given


def everything(course: Course) -> dict[str, Mapping]:
    """Return the content of a gradebook, by kind and by key."""
    found = records(course)
    graded = {(each.student_id, each.assignment) for each in found if each.submitted}
    pages = course.folder('feedback', '', '').glob('*/*/*.html')
    with closing(sqlite3.connect(course.database)) as database:
        assert database.execute('PRAGMA integrity_check').fetchone() == ('ok',)
        tables = {name: _rows(database, query) for name, query in _DATABASE.items()}
    return tables | {
        'record': {(r.student_id, r.assignment, r.grade_id): r for r in found},
        'verdict': {
            (*whose, cell): _told(said)
            for whose in sorted(graded)
            for cell, said in verdicts(course, *whose).items()
        },
        'feedback': {page.parts[-3:]: _words(page.read_text('utf-8')) for page in pages},
    }


def differ(whole: Mapping[str, Mapping], other: Mapping[str, Mapping]) -> bool:
    """Print how many entries of each kind differ, and which; return whether any does."""
    print('Differs from the run that nobody ended:')
    lines = []
    for kind, ours in whole.items():
        theirs = other[kind]
        places = [p for p in sorted({*ours, *theirs}, key=str) if ours.get(p) != theirs.get(p)]
        print(f'  {kind}: {len(places)} of {len(ours)}')
        lines += [f'  {kind} {p}: {_told_apart(ours.get(p), theirs.get(p))}' for p in places]
    print(*lines[:MOST_SHOWN], sep='\n')
    return bool(lines)


def _told_apart(one: object, other: object) -> str:
    if isinstance(one, Counter) and isinstance(other, Counter):
        one, other = dict(one - other), dict(other - one)
    return f'{one}, and in the other {other}'


def _rows(database: sqlite3.Connection, query: str) -> dict[tuple, list[tuple]]:
    """Return rows by their first two columns, as lists, so that duplicates are kept."""
    found: dict[tuple, list[tuple]] = {}
    for row in sorted(database.execute(query), key=str):
        found.setdefault(row[:2], []).append(row[2:])
    return found


def _told(verdict: Mapping) -> tuple:
    return verdict.get('outcome'), *map(_timeless, _texts(verdict))


def _texts(verdict: Mapping) -> Iterator[str]:
    yield verdict.get('reason') or ''
    yield from verdict.get('notes') or ()


def _words(page: str) -> Counter[str]:
    return Counter(re.findall(r'\w+', _timeless(page)))


def _timeless(text: str) -> str:
    return _TIMES_OF_RUNS.sub('#', ' '.join(text.split()))
