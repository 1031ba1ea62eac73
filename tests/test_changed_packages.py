"""Packages of students, right in unusual ways, wrong and hostile: each earns what it should."""

import re

import nbformat
import pytest
from answered import read
from changed_packages import ALL
from package_changes import CHECKS, FULL, LESSON, Change, ours, write
from right_packages import RIGHT
from wrong_packages import HOSTILE, WRONG

from grader.course import Course
from grader.grade import grade_all
from grader.storage.records import records, verdicts
from grader.storage.submitted import find_submissions

ORDINARY = {'stops_at_the_first_unreachable'}
"""Those that an ordinary run grades; `./course test --slow` takes all."""


def wrongly_judged(changes: tuple[Change, ...], course: Course) -> list[str]:
    """Grade packages as one class; return those with unexpected points or reasons."""
    for change in changes:
        folder = course.folder('submitted', change.name, LESSON)
        folder.mkdir(parents=True)
        nbformat.write(read('notebooks', LESSON), folder / f'{LESSON}.ipynb')
        write(change.files(), folder)
    rows = list(grade_all(course, find_submissions(course)))
    assert [row for row in rows if not row.stored] == []
    scores = {(each.student_id, each.grade_id): each.score for each in records(course)}
    wrong = []
    for change in changes:
        said = verdicts(course, change.name, LESSON)
        for check, full, points in zip(CHECKS, FULL, change.points, strict=True):
            told = ' | '.join([said[check].reason, *said[check].notes])
            is_told = points == full or (told and re.search(change.says.get(check, ''), told))
            if scores[change.name, check] != points or not is_told:
                wrong.append(f'{change.name}, {check}: {scores[change.name, check]}: {told}')
    return wrong


def test_packages_differ_and_only_right_ones_earn_full_points():
    packages = [tuple(sorted(change.files().items())) for change in ALL]
    assert len(set(packages)) == len(ALL) == len({change.name for change in ALL})
    assert ALL[0].files() == ours()
    assert all(change.points == FULL for change in RIGHT)
    assert all(change.points != FULL for change in (*WRONG, *HOSTILE))
    assert {change.name for change in ALL} >= ORDINARY


@pytest.mark.slow
@pytest.mark.starts
def test_selected_packages_get_the_expected_points_and_messages(tmp_path):
    changes = tuple(change for change in ALL if change.name in ORDINARY)
    assert wrongly_judged(changes, Course(gradebook=tmp_path)) == []


@pytest.mark.slow
@pytest.mark.starts
@pytest.mark.parametrize('kind', [RIGHT, WRONG, HOSTILE], ids=['right', 'wrong', 'hostile'])
def test_every_package_gets_the_expected_points_and_messages(kind, tmp_path):
    assert '\n'.join(wrongly_judged(kind, Course(gradebook=tmp_path))) == ''
