"""The student and the assignment of a file, from the names of folders and files."""

from pathlib import Path

import pytest
from incoming_files import ASSIGNMENTS, arriving, owners

from grader.collect.incoming import Incoming
from grader.collect.matching import match


@pytest.fixture
def at(tmp_path):
    return arriving(tmp_path)


@pytest.mark.parametrize(
    'path',
    [
        'ada_02_joint_state.ipynb',
        'ada-02_joint_state.ipynb',
        'ada 02_joint_state (1).ipynb',
        'ada - Copy of 02_joint_state.ipynb',
        'Copy of ada - 02_joint_state.ipynb',
        'Kopie von Copy of ada_02_joint_state.ipynb',
        'ada_02_joint_state/02_joint_state.ipynb',
        'ada/02_joint_state.ipynb',
        'ada/02_joint_state/02_joint_state.ipynb',
        'ada/ada_02_joint_state.ipynb',
        'term 1/submitted/ada/02_joint_state/02_joint_state.ipynb',
        '02_joint_state/ada/02_joint_state.ipynb',
        'ada.zip/02_joint_state.ipynb',
        'ada.zip/notebooks/02_joint_state/02_joint_state.ipynb',
        'ada.zip/my homework/02_joint_state.ipynb',
        'ada.zip/ada_02_joint_state.ipynb',
        'ada_02_joint_state.zip/02_joint_state.ipynb',
        'ada/02_joint_state.zip/02_joint_state.ipynb',
        'inbound/ada+02_joint_state+2026-01-01 10:00:00.5 UTC/02_joint_state.ipynb',
        'ada+02_joint_state+2026-01-01 10_00_00 UTC+xyz=/02_joint_state.ipynb',
        'ada_1815_assignsubmission_file_/02_joint_state.ipynb',
        'ada_1815_assignsubmission_file_/Copy of 02_joint_state.ipynb',
        'ada_1815_assignsubmission_file_02_joint_state.ipynb',
        'ada_18151_21012_02_joint_state-1.ipynb',
        'ada_LATE_18151_21012_02_joint_state.ipynb',
        'Lab 2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'gradebook_ROS_Lab_2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'gradebook_ROS_Lab_2/Lab 2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'Lab 2_ada_attempt_2026-01-02-03-04-05_work.zip/02_joint_state.ipynb',
        'ada/Late Submission - 02_joint_state.ipynb',
    ],
)
def test_student_and_assignment_are_found_in_the_path_of_a_notebook(path, at):
    assert owners(at(path)) == ([('ada', '02_joint_state')], [])


@pytest.mark.parametrize(
    'name',
    [
        '小明',
        'Bob Kopie',
        'Copy ofer',
        'Зоя',
        'Ada Lovelace',
        "o'hara",
        'a+b',
        '=cmd()',
        'x[1]*',
        'نگار\u200cمحمدی',
    ],
)
def test_names_from_any_alphabet_are_kept(name, at):
    for path in (f'{name}_02_joint_state.ipynb', f'{name}/02_joint_state.ipynb'):
        assert owners(at(path)) == ([(name, '02_joint_state')], [])


@pytest.mark.parametrize(
    'path',
    [
        'Kurs ROS_101_assignsubmission_file_/ada/02_joint_state.ipynb',
        'ROS_Kurs_attempt_2026-01-02-03-04-05/ada/02_joint_state.ipynb',
        'kurs+02_joint_state+2026-01-01 10:00:00 UTC/02_joint_state.ipynb',
        'homework_02_joint_state.zip/02_joint_state.ipynb',
        'Hausaufgabe 2_02_joint_state.ipynb',
        'Copy of 02_joint_state.ipynb',
        'Kopie von 02_joint_state.ipynb',
    ],
)
def test_a_word_for_work_or_a_class_is_not_taken_as_a_student(path, at):
    taken, [(_, why)] = owners(at(path))
    assert taken == []
    assert 'names work or a class' in why


def test_a_name_is_the_same_however_its_letters_are_composed(at):
    found = owners(at('Zoe\u0308_02_joint_state.ipynb'), at('Zo\u00eb_03_publisher.ipynb'))
    assert {student for student, _ in found[0]} == {'Zo\u00eb'}


def test_a_file_named_after_no_assignment_is_refused_with_a_list_of_all(at):
    _, (left,) = match([at('ada/homework.ipynb')], ['00_arm', '01_a_longer_name'])
    assert ', with 00_arm, 01_a_longer_name; rename it' in left.reason


@pytest.mark.parametrize(
    ('path', 'reason'),
    [
        ('02_joint_state.ipynb', 'nothing says whose it is: expected STUDENT_ASSIGNMENT.ipynb'),
        ('02_joint_state.zip/02_joint_state.ipynb', 'nothing says whose it is'),
        ('notebooks/02_joint_state/02_joint_state.ipynb', 'nothing says whose it is'),
        ('ada/homework.ipynb', 'named after no assignment: '),
        ('ada_2_joint_state.ipynb', 'named after no assignment: '),
        ('ada/02_joint_state-Copy1.ipynb', 'named after no assignment: '),
        ('ada/03_publisher/02_joint_state.ipynb', 'in a folder of another assignment, 03_pub'),
        ('ada_03_publisher/02_joint_state.ipynb', 'in a folder of another assignment, 03_pub'),
        ('bob.zip/ada_02_joint_state.ipynb', 'named after ada, and in the archive of bob'),
        (
            'ada+02_joint_state+2026-01-01 10:00:00 UTC/03_publisher.ipynb',
            'in the exchange, 02_joint_state.ipynb was expected here',
        ),
        ('.._02_joint_state.ipynb', 'no name of a student'),
        ('\x1b[31mred_02_joint_state.ipynb', "characters that can't be shown"),
        ('ada\n/02_joint_state.ipynb', "characters that can't be shown"),
        ('ada\u202e_02_joint_state.ipynb', "characters that can't be shown"),
        ('\udcff_02_joint_state.ipynb', "characters that can't be shown"),
        ('a' * 129 + '_02_joint_state.ipynb', 'too long'),
        (' /02_joint_state.ipynb', 'no name of a student'),
    ],
)
def test_a_file_without_a_clear_student_or_assignment_is_left_with_a_reason(path, reason, at):
    taken, [(left, why)] = owners(at(path, 'x'))
    assert taken == []
    assert left == path
    assert reason in why


def test_a_file_named_after_another_student_than_its_folder_is_left_out(at):
    mine, forged = at('class/ada/02_joint_state.ipynb'), at('class/bob/ada_02_joint_state.ipynb')
    taken, [(left, why)] = owners(mine, forged)
    assert taken == [('ada', '02_joint_state')]
    assert left == forged.path
    assert 'named after ada, and in a folder bob' in why


def test_a_folder_that_contains_all_submissions_is_not_a_student(at):
    found = owners(at('week 3/ada_02_joint_state.ipynb'), at('week 3/bob_02_joint_state.ipynb'))
    assert found == ([('ada', '02_joint_state'), ('bob', '02_joint_state')], [])


def test_python_files_go_with_the_notebooks_of_one_student(at):
    hand_ins, left = match(
        [
            at('ada/02_joint_state.ipynb'),
            at('ada/03_publisher.ipynb'),
            at('ada/helper.py'),
            at('bob_02_joint_state.ipynb'),
            at('whose.py'),
            at('eve.zip/eve_02_joint_state.ipynb'),
            at('eve.zip/mine.py'),
            at('eve.zip/other/far.py'),
            at('eve.zip/a\x1b.py'),
        ],
        ASSIGNMENTS,
    )
    extra = {(each.student_id, each.assignment): list(each.extra) for each in hand_ins}
    assert extra == {
        ('ada', '02_joint_state'): ['helper.py'],
        ('ada', '03_publisher'): ['helper.py'],
        ('bob', '02_joint_state'): [],
        ('eve', '02_joint_state'): ['mine.py'],
    }
    assert {each.incoming.parts[-1] for each in left} == {'whose.py', 'far.py', 'a\x1b.py'}


def test_unreadable_files_matter_and_files_of_other_types_do_not(at):
    _, left = match([at('a.zip', problem='broken'), at('ada/notes.txt')], ASSIGNMENTS)
    assert [(each.reason, each.needs_attention) for each in left] == [
        ('broken', True),
        ('neither a notebook nor Python', False),
    ]


ALONE = 'no notebook: ask for 03_publisher.ipynb'


@pytest.mark.parametrize(
    'path',
    [
        'bob/03_publisher.html',
        'bob/03_publisher.py',
        'bob_03_publisher.PDF',
        'bob - Copy of 03_publisher.docx',
        'bob/bob_03_publisher (1).htm',
        'bob.zip/work/03_publisher.txt',
        'bob_18151_21012_03_publisher-1.html',
        'Bob_2_assignsubmission_file_/03_publisher.html',
        'Bob_2_assignsubmission_file_03_publisher.html',
    ],
)
def test_a_lesson_handed_in_as_another_kind_of_file_alone_needs_attention(path, at):
    _, [left] = match([at(path), at('ada/03_publisher.ipynb')], ASSIGNMENTS)
    assert left.reason.startswith(ALONE)
    assert left.needs_attention


@pytest.mark.parametrize(
    ('notebook', 'other'),
    [
        ('bob/03_publisher.ipynb', 'bob/03_publisher.html'),
        ('bob/03_publisher.ipynb', 'bob/export/03_publisher.pdf'),
        ('bob_03_publisher.ipynb', 'bob_03_publisher.html'),
        ('bob_18151_21012_03_publisher.ipynb', 'bob_18151_21013_03_publisher-1.html'),
        ('Bob_2_assignsubmission_file_/03_publisher.ipynb',
         'Bob_2_assignsubmission_file_/03_publisher.html'),
        ('bob/03_publisher.ipynb', 'bob/notes.html'),
    ],
)  # fmt: skip
def test_another_kind_of_file_beside_the_notebook_needs_no_attention(notebook, other, at):
    _, [left] = match([at(notebook), at(other)], ASSIGNMENTS)
    assert (left.reason, left.needs_attention) == ('neither a notebook nor Python', False)


def test_another_lesson_or_another_student_s_notebook_is_no_notebook_for_it(at):
    others = at('bob/02_joint_state.ipynb'), at('ada_03_publisher.ipynb')
    _, left = match(
        [at('bob/03_publisher.html'), at('eve_03_publisher.html'), *others], ASSIGNMENTS
    )
    assert [each.reason.startswith(ALONE) for each in left] == [True, True]


def test_an_archive_named_homework_does_not_name_a_student(at):
    taken, left = owners(
        at('Ada_1_assignsubmission_file_/homework.zip/03_publisher.ipynb'),
        at('Bob_2_assignsubmission_file_/homework.zip/03_publisher.ipynb'),
    )
    assert (taken, left) == ([('Ada', '03_publisher'), ('Bob', '03_publisher')], [])
    for name in ('homework.zip', 'homework (1).zip', 'HW3.zip', 'Hausaufgabe 2.zip', '作业.zip'):
        taken, [(_, why)] = owners(at(f'{name}/03_publisher.ipynb'))
        assert taken == []
        assert 'nothing says whose it is' in why
    taken, [(_, why)] = owners(at('homework.zip/ada_03_publisher.ipynb'))
    assert taken == []
    assert 'nothing says whose it is' in why


def test_students_are_found_in_folders_of_weeks_beside_single_files(at):
    assert owners(
        at('week 3/ada/03_publisher.ipynb'),
        at('week 3/bob/03_publisher.ipynb'),
        at('week 2/ada/02_joint_state.ipynb'),
        at('zoe_03_publisher.ipynb'),
    ) == (
        [
            ('ada', '02_joint_state'),
            ('ada', '03_publisher'),
            ('bob', '03_publisher'),
            ('zoe', '03_publisher'),
        ],
        [],
    )


def test_a_person_decides_if_two_folders_may_name_the_student(at):
    paths = 'CS101/ada/03_publisher.ipynb', 'CS102/bob/03_publisher.ipynb'
    taken, left = owners(*map(at, paths))
    assert taken == []
    assert [why[:27] for _, why in left] == [
        'it may be of CS101 or of ad',
        'it may be of CS102 or of bo',
    ]


@pytest.mark.parametrize('name', ['fay_03_Publisher.ipynb', '03_publisher_fay.ipynb'])
def test_the_reason_for_a_nearly_right_name_lists_only_its_assignment(name):
    _, [left] = match([Incoming((name,), Path(name))], ['02_joint_state', '03_publisher'])
    assert left.reason.startswith('named after no assignment: expected STUDENT_ASSIGNMENT.ipynb')
    assert 'with 03_publisher; rename it, in an unpacked copy of an archive' in left.reason
