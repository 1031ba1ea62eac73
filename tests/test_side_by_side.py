"""The checks of a package are judged in two parts at the same time, if nothing else is graded."""

import asyncio
from dataclasses import replace

import pytest
from answered import answered, read
from fake_rooms import FakeRooms, ended
from my_robot_basics.validate.lessons.cells import grade_id
from my_robot_basics.validate.lessons.exercises import find_exercises
from my_robot_basics.validate.running import run
from my_robot_basics.validate.verdicts.judging import JudgedExercise
from my_robot_basics.validate.verdicts.side_by_side import join_judged, split_exercise
from package_changes import FULL, LESSON, ours, write
from package_maker import package_lesson

from grader.judging import execute as module


def names(notebook, exercise):
    return [grade_id(notebook.cells[index]) for index in exercise.grades]


def test_our_lesson_is_divided_in_both_versions():
    for folder in 'solutions', 'notebooks':
        notebook = read(folder, LESSON)
        [exercise] = find_exercises(notebook)
        assert len(split_exercise(notebook, exercise)) == 2


def test_the_last_check_of_a_package_is_a_part_of_its_own():
    notebook = package_lesson()
    [exercise] = find_exercises(notebook)
    parts = split_exercise(notebook, exercise)
    assert [names(notebook, part) for part in parts] == [['builds'], ['runs']]
    assert {replace(part, grades=exercise.grades) for part in parts} == {exercise}


def test_another_exercise_stays_whole():
    notebook = package_lesson()
    [exercise] = find_exercises(notebook)
    for whole in (
        replace(exercise, grades=exercise.grades[:1]),
        replace(exercise, grades=()),
        replace(exercise, packages=()),
    ):
        assert split_exercise(notebook, whole) == (whole,)


def test_a_check_that_reads_a_name_of_an_earlier_one_is_not_a_part_of_its_own():
    notebook = package_lesson(builds='greeter = 1', runs='print(greeter)')
    [exercise] = find_exercises(notebook)
    assert split_exercise(notebook, exercise) == (exercise,)
    own = package_lesson(builds='greeter = 1', runs='greeter = 2; print(greeter)')
    assert len(split_exercise(own, exercise)) == 2


@pytest.mark.parametrize(
    'checks',
    [
        {'builds': 'from math import *', 'runs': 'print(pi)'},
        {'builds': 'greeter = 1', 'runs': "print(globals()['greeter'])"},
    ],
)
def test_a_check_that_may_read_such_a_name_is_not_a_part_of_its_own(checks):
    notebook = package_lesson(**checks)
    [exercise] = find_exercises(notebook)
    assert split_exercise(notebook, exercise) == (exercise,)


def test_results_are_joined_in_the_order_of_the_checks_and_the_first_run_counts():
    first, second = JudgedExercise({1: 'a', 2: 'b'}, {4: 'x'}), JudgedExercise({1: 'c'}, {5: 'y'})
    joined = join_judged([first, second])
    assert joined.runs == {1: 'a', 2: 'b'}
    assert list(joined.checks.items()) == [(4, 'x'), (5, 'y')]
    assert join_judged([]) == JudgedExercise({}, {})


@pytest.mark.parametrize('others', [0, 1])
def test_a_package_is_divided_only_if_no_other_notebook_is_graded(monkeypatch, others):
    """Each notebook that is graded later opens rooms once, for both checks."""
    opened = []

    class Rooms(FakeRooms):
        checks = []

        def __init__(self, **options):
            super().__init__(**options)
            opened.append(self)
            self.ran = []

        async def run_check(self, source):
            self.ran.append('builds' if 'expect_built' in source else 'runs')
            await asyncio.sleep(0.05)
            return ended()

    async def several():
        papers = [package_lesson() for _ in range(1 + others)]
        return await asyncio.gather(*map(module.execute_exercises, papers))

    monkeypatch.setattr(module, 'GradingRooms', Rooms)
    for execution in asyncio.run(several()):
        assert [each.grade_id for each in execution.verdicts] == ['builds', 'runs']
    ran = [rooms.ran for rooms in opened]
    assert sorted(ran) == sorted([['builds'], ['runs'], *[['builds', 'runs']] * others])


@pytest.mark.parametrize('is_edited', [False, True])
def test_an_answer_that_is_edited_between_the_parts_is_not_remembered(
    monkeypatch, tmp_path, is_edited
):
    path = answered(LESSON, tmp_path)
    write(ours(), path.parent)
    judged = []

    async def judge(notebook, exercise, open_rooms, budget):
        judged.append(names(notebook, exercise))
        if is_edited:
            (path.parent / 'arm_player/setup.py').write_text(f'# {len(judged)}')
        return JudgedExercise({}, {})

    monkeypatch.setattr(run, 'judge_exercise', judge)
    told = asyncio.run(run.validate(path, None))
    assert len(judged) == 2
    assert sum(map(len, judged)) == len(FULL)
    assert (told.parts[0].answer == '') is is_edited
