"""Unusual answers, right and wrong: each gets the expected points and reasons."""

import answer_table
import nbformat
import pytest
from answer_table import Answer, all_answers, answers_to, in_class, paper
from answered import LESSONS, read
from my_robot_basics.validate.lessons.exercises import find_exercises

from grader.course import Course
from grader.grade import grade_all
from grader.storage.records import records, verdicts
from grader.storage.submitted import find_submissions

ORDINARY = {
    *('five_hz-drops_tenth', 'ik_solver_node-gives_up', 'fix_topic_name-lags'),
    *('ik_client-await_in_the_group', 'count_turns-a_bound_less'),
}
"""Answers that a faulty grader most likely misjudges: few enough to be graded together."""


def wrongly_judged(answers: list[Answer], course: Course) -> list[str]:
    """Grade answers as one class; return those with unexpected points or reasons."""
    whose = {}
    for number, together in enumerate(in_class(answers)):
        student, lesson = f'student{number}', together[0].lesson
        folder = course.folder('submitted', student, lesson)
        folder.mkdir(parents=True)
        nbformat.write(paper(together), folder / f'{lesson}.ipynb')
        whose |= {each.id: (student, lesson) for each in together}
    rows = list(grade_all(course, find_submissions(course)))
    assert [row for row in rows if not row.stored] == []
    scores = {(each.student_id, each.grade_id): each.score for each in records(course)}
    wrong = []
    for each in answers:
        student, lesson = whose[each.id]
        said = verdicts(course, student, lesson)
        for check, points in each.points.items():
            told = ' | '.join([said[check].reason, *said[check].notes])
            score = scores[student, check]
            if score != points or (each.lost(check) and (not told or each.says not in told)):
                wrong.append(f'{each.id} ({each.why}), {check}: {score}, not {points:g}: {told}')
    return wrong


def test_each_answer_has_its_own_id_and_code():
    answers = all_answers()
    assert len({each.id for each in answers}) == len(answers) > 700
    assert {each.id for each in answers} >= ORDINARY
    for exercise in {each.exercise for each in answers}:
        codes = [(each.code, *each.cells.items()) for each in answers_to(exercise)]
        assert [code for code in codes if codes.count(code) > 1] == []


def test_every_lesson_has_answers_and_the_first_of_each_exercise_earns_full_points():
    usual = [answers_to(exercise)[0] for exercise in {each.exercise for each in all_answers()}]
    packages = {'12_package'}  # whose answer is a folder: tests/changed_packages.py
    assert {each.lesson for each in usual} == set(LESSONS) - packages
    assert all(each.points == each.full for each in usual)


def test_a_table_of_answers_names_each_check_of_its_exercise_with_its_points():
    for first in (
        answers_to(exercise)[0] for exercise in {each.exercise for each in all_answers()}
    ):
        cells = (lesson := read('notebooks', first.lesson)).cells
        (exercise,) = (each for each in find_exercises(lesson) if each.name == first.exercise)
        marks = [cells[index].metadata.nbgrader for index in exercise.grades]
        checks = {mark.grade_id: mark.points for mark in marks}
        assert first.full == checks, f'the lines `check` in tests/answers/{first.exercise}.txt'


@pytest.mark.parametrize(
    ('lines', 'why'),
    [
        (['right b: also so', '-no such line'], "'no such line' is no line of the first answer"),
        (['right b: also so', 'points 1'], "'points 1' begins with none of"),
        (['right b: also so', 'earns 0'], 'it is right, and earns'),
        (['wrong b: not so', 'earns 0 1', '+x = 3'], 'zip'),
    ],
)
def test_an_error_in_a_table_of_answers_names_the_answer(lines, why, tmp_path, monkeypatch):
    head = 'lesson 00_two_link_arm\ncheck it 1'
    table = tmp_path / 'reaching.txt'
    table.write_text('\n\n'.join([head, 'right a: so\n+x = 2', '\n'.join(lines)]))
    monkeypatch.setattr(answer_table, 'FOLDER', tmp_path)
    with pytest.raises(ValueError, match=rf"^reaching\.txt: the answer '{lines[0]}': .*{why}"):
        answers_to.__wrapped__('reaching')


@pytest.mark.slow
@pytest.mark.starts
def test_selected_answers_get_the_expected_points_and_messages(tmp_path):
    answers = [each for each in all_answers() if each.id in ORDINARY]
    assert wrongly_judged(answers, Course(gradebook=tmp_path)) == []


@pytest.mark.slow
@pytest.mark.starts
@pytest.mark.timeout(3600)
@pytest.mark.parametrize('exercise', sorted({each.exercise for each in all_answers()}))
def test_every_answer_gets_the_expected_points_and_messages(exercise, tmp_path, pytestconfig):
    only = pytestconfig.getoption('--answer')
    answers = [each for each in answers_to(exercise) if only in (None, each.name)]
    assert answers, f'{exercise} has no answer {only}'
    assert wrongly_judged(answers, Course(gradebook=tmp_path)) == []
