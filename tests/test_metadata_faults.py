"""Each omission in Create Assignment is reported with its cell, before nbgrader reads it."""

import re

import pytest
from course_maker import TOY, make_course, toy_lesson, write_source
from nbformat import from_dict
from nbgrader.nbgraderformat import MetadataValidator, SchemaTooOldError, ValidationError

from grader.authoring.metadata_faults import metadata_faults
from grader.authoring.release import release
from grader.common.errors import CourseError
from grader.storage.registering import register

FAULTS = {
    'no id': (
        {'grade_id': ''},
        'cell 8 of the notebook needs an ID in Create Assignment: letters, digits, - and _, which'
        ' no other cell has',
    ),
    'an id with a space': (
        {'grade_id': 'more numbers'},
        'the cell `more numbers` needs an ID in Create Assignment: letters, digits, - and _, which'
        ' no other cell has',
    ),
    'the id of another': (
        {'grade_id': 'double-check'},
        'two cells have the ID `double-check`: give the second one another in Create Assignment',
    ),
    'no points': (
        {'points': None},
        'the cell `double-hidden` has no points: write a number from 0 on into Points in Create'
        ' Assignment',
    ),
    'less than no points': (
        {'points': -1},
        'the cell `double-hidden` has -1 points: write a number from 0 on into Points in Create'
        ' Assignment',
    ),
    'points that are no number': (
        {'points': True},
        'the cell `double-hidden` has True points: write a number from 0 on into Points in Create'
        ' Assignment',
    ),
    'a task in code': (
        {'task': True},
        'the cell `double-hidden` is a task in a code cell: make it a markdown cell, or choose '
        'another type for it',
    ),
    'an id that is a number': (
        {'grade_id': 5},
        'the cell `5` needs an ID in Create Assignment: letters, digits, - and _, which no other'
        ' cell has',
    ),
    'old metadata': (
        {'schema_version': 2},
        'the cell `double-hidden` is of another version of nbgrader: .venv/bin/nbgrader update'
        ' solutions brings it up to date',
    ),
}


@pytest.mark.parametrize(('marks', 'fault'), FAULTS.values(), ids=FAULTS)
def test_each_fault_in_create_assignment_is_reported_with_a_remedy(marks, fault):
    lesson = toy_lesson()
    assert list(metadata_faults(lesson)) == []
    lesson.cells[7].metadata.nbgrader.update(marks)
    assert list(metadata_faults(lesson)) == [fault]


@pytest.mark.parametrize(
    ('marks', 'fault'),
    [
        ({}, 'cell 1 of the notebook is of another version of nbgrader: '),
        (
            {'schema_version': 3, 'grade': False, 'locked': False},
            "cell 1 of the notebook lacks 'solution': choose its type again in Create Assignment",
        ),
    ],
)
def test_a_cell_without_a_type_that_nbgrader_refuses_is_reported(marks, fault):
    lesson = toy_lesson()
    lesson.cells[0].metadata['nbgrader'] = from_dict(marks)
    with pytest.raises((SchemaTooOldError, ValidationError)):
        MetadataValidator().validate_nb(lesson)
    [said] = metadata_faults(lesson)
    assert said.startswith(fault)


def test_a_check_in_markdown_and_a_written_answer_without_points_are_reported():
    lesson = toy_lesson()
    lesson.cells[7].cell_type = 'markdown'
    lesson.cells[8].metadata.nbgrader.grade = False
    as_check, as_answer = metadata_faults(lesson)
    assert as_check.startswith(
        'the cell `double-hidden` is a check in a markdown cell: make it a code'
    )
    assert as_answer.startswith('the cell `explain` is an answer in words, which no check can')


def test_a_check_that_is_not_valid_python_is_reported_with_the_line():
    lesson = toy_lesson()
    lesson.cells[6].source += '\nif seen =='
    [fault] = metadata_faults(lesson)
    assert re.match(
        r'the cell `double-check` is a check that is not valid Python: line 5: \w', fault
    )


def test_a_check_that_uses_a_name_of_the_lesson_is_reported():
    lesson = toy_lesson()
    lesson.cells[7].source += '\nassert seen == double(0)'  # the check above binds `seen`
    assert list(metadata_faults(lesson)) == [
        "the cell `double-hidden` uses 'double', which it does not bind: a check runs apart from"
        ' the lesson, so import or define it in the check'
    ]


@pytest.mark.parametrize('use', [release, lambda course: register(course, TOY)])
def test_release_and_register_name_the_lesson_and_its_faulty_cell(use, tmp_path):
    lesson = toy_lesson()
    del lesson.cells[4].metadata['nbgrader']
    course = make_course(tmp_path / 'course')
    write_source(course, lesson)
    said = f'solutions/{TOY}/{TOY}.ipynb cannot be released: the cell `double`, line 3: '
    with pytest.raises(CourseError, match=f'^{re.escape(said)}'):
        use(course)
