from pathlib import Path

import pytest

from grader.collect.platforms import student_in
from grader.common.student_names import UnclearOwner, problem_of_id


@pytest.mark.parametrize(
    ('name', 'student'),
    [
        ('Ada Lovelace', 'Ada Lovelace'),
        (' ada ', 'ada'),
        ('Ada Lovelace_1815_assignsubmission_file_', 'Ada Lovelace'),
        ('lovelaceada_18151_21012_ada', 'lovelaceada'),
        # no upload: Canvas writes the name of a file behind it
        ('lovelaceada_18151_21012', 'lovelaceada_18151_21012'),
        ('lovelaceada_LATE_18151_21012_ada', 'lovelaceada'),
        ('group_1_2', 'group_1_2'),
        ('Zoe\u0308', 'Zo\u00eb'),
    ],
)
def test_additions_of_a_course_management_system_are_removed_from_a_name(name, student):
    assert student_in(name) == student


def test_two_dots_are_refused_as_the_name_of_a_student():
    with pytest.raises(UnclearOwner, match='no name of a student'):
        student_in('..')


@pytest.mark.parametrize(
    'student', ['ada', '小明', "O'Neill", 'é' * 100, 'a.b', 'نگار\u200cمحمدی']
)
def test_a_student_id_that_can_be_a_folder_name_has_no_problem(student):
    assert problem_of_id(student) == ''
    assert Path(student).name == student


NO_IDS = [
    'a\u200db',
    'ada\u3164',
    'ada\u202e',
    'a\nb',
    'a\tb',
    '',
    '.',
    '..',
    '.git',
    'a/b',
    'a\0b',
    '\u200c',
    '小' * 70,
    '<b>a',
    'a" onclick="b',
]


@pytest.mark.parametrize('student', NO_IDS)
def test_a_student_id_that_cannot_be_a_folder_name_has_a_problem(student):
    assert problem_of_id(student)
