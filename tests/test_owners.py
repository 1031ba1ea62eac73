from datetime import UTC, datetime

import pytest

from grader.incoming import Incoming
from grader.owners import match

ASSIGNMENTS = ['00_two_link_arm', '02_joint_state', '03_publisher']
LATER = datetime(2026, 1, 1, 12, tzinfo=UTC)


@pytest.fixture
def at(tmp_path):
    """What comes in at a path; a folder that ends in .zip is a student's archive."""

    def incoming(path, content='', *, modified=LATER, problem=''):
        parts = tuple(path.split('/'))
        file = tmp_path / f'{len(list(tmp_path.iterdir()))}'
        file.write_text(content or path)
        archives = [i for i, part in enumerate(parts[:-1], 1) if part.endswith('.zip')]
        return Incoming(parts, file, modified, problem, archives[0] if archives else 0)

    return incoming


def owners(*found, **options):
    hand_ins, left = match(found, ASSIGNMENTS, **options)
    return [(each.student_id, each.assignment) for each in hand_ins], [
        (each.incoming.path, each.reason) for each in left
    ]


@pytest.mark.parametrize(
    'path',
    [
        'ada_02_joint_state.ipynb',
        'ada-02_joint_state.ipynb',
        'ada 02_joint_state (1).ipynb',
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
        'ada_1815_assignsubmission_file_02_joint_state.ipynb',
        'ada_18151_21012_02_joint_state-1.ipynb',
        'ada_LATE_18151_21012_02_joint_state.ipynb',
    ],
)
def test_a_notebook_finds_its_student_and_its_assignment(path, at):
    assert owners(at(path)) == ([('ada', '02_joint_state')], [])


@pytest.mark.parametrize(
    'name', ['小明', 'Зоя', 'Ada Lovelace', "o'hara", 'a+b', '=cmd()', 'x[1]*', 'نگار\u200cمحمدی']
)
def test_names_from_any_alphabet_are_kept(name, at):
    for path in (f'{name}_02_joint_state.ipynb', f'{name}/02_joint_state.ipynb'):
        assert owners(at(path)) == ([(name, '02_joint_state')], [])


def test_a_name_is_the_same_however_its_letters_are_composed(at):
    found = owners(at('Zoe\u0308_02_joint_state.ipynb'), at('Zo\u00eb_03_publisher.ipynb'))
    assert {student for student, _ in found[0]} == {'Zo\u00eb'}


def test_who_named_no_assignment_reads_all_of_them_in_order(at):
    _, (left,) = match([at('ada/homework.ipynb')], ['00_arm', '01_a_longer_name'])
    assert left.reason.endswith(', with 00_arm, 01_a_longer_name')


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
def test_what_is_nobodys_is_left_with_a_reason(path, reason, at):
    taken, [(left, why)] = owners(at(path, 'x'))
    assert taken == []
    assert left == path
    assert reason in why


def test_nobody_is_named_by_a_file_in_somebody_elses_folder(at):
    mine, forged = at('class/ada/02_joint_state.ipynb'), at('class/bob/ada_02_joint_state.ipynb')
    taken, [(left, why)] = owners(mine, forged)
    assert taken == [('ada', '02_joint_state')]
    assert left == forged.path
    assert 'named after ada, and in a folder bob' in why


def test_a_folder_that_holds_all_is_no_student(at):
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


def time_of(*found, **options):
    (hand_in,), left = match(found, ASSIGNMENTS, **options)
    when = hand_in.handed_in
    return when and when.strftime('%m-%d %H:%M:%S'), [each.reason for each in left]


def test_the_time_is_the_exchanges_or_the_files(at):
    notebook = at('ada/02_joint_state/02_joint_state.ipynb')
    stamp = at('ada/02_joint_state/timestamp.txt', '2026-03-04 05:06:07.89 UTC\n')
    assert time_of(notebook, stamp) == ('03-04 05:06:07', [])
    assert time_of(notebook) == (None, [])
    assert time_of(notebook, file_times=True) == ('01-01 12:00:00', [])
    assert time_of(notebook, stamp, file_times=True) == ('03-04 05:06:07', [])
    zone = at('ada/02_joint_state/timestamp.txt', '2026-03-04 05:06:07 +0200')
    assert time_of(notebook, zone) == ('03-04 03:06:07', [])
    exchange = 'ada+02_joint_state+2026-02-03 04:05:06.7 UTC'
    exchanged = at(f'{exchange}/02_joint_state.ipynb'), at(f'{exchange}/timestamp.txt', 'soon')
    assert time_of(*exchanged) == ('02-03 04:05:06', ['it holds no date'])


def test_a_time_that_a_student_packed_is_not_believed(at):
    notebook, stamp = at('ada.zip/02_joint_state.ipynb'), at('ada.zip/timestamp.txt', '2020-01-01')
    assert time_of(notebook, stamp) == (
        None,
        ["a time in a student's own archive is not believed"],
    )


def test_several_notebooks_of_one_exercise_are_put_in_order_by_their_times(at):
    exchange = 'ada+02_joint_state+2026-01-0{} 10:00:00 UTC/02_joint_state.ipynb'
    hand_ins, left = match([at(exchange.format(day)) for day in (3, 1, 2)], ASSIGNMENTS)
    assert [each.handed_in.day for each in hand_ins] == [1, 2, 3]
    assert left == []


def test_where_no_time_tells_them_apart_none_is_taken(at):
    two = at('ada_02_joint_state.ipynb', 'one'), at('ada-02_joint_state.ipynb', 'two')
    for options in ({}, {'file_times': True}):  # they are of the same time, too
        taken, left = owners(*two, **options)
        assert taken == []
        assert [path for path, _ in left] == [each.path for each in two]
        assert all('one of 2 notebooks for 02_joint_state by ada' in why for _, why in left)


def test_the_same_notebook_twice_is_one(at):
    two = at('ada_02_joint_state.ipynb', 'one'), at('ada-02_joint_state.ipynb', 'one')
    taken, [(_, why)] = owners(*two)
    assert taken == [('ada', '02_joint_state')]
    assert why == 'the same again'


def test_what_can_t_be_read_and_what_nobody_grades_is_told_apart(at):
    _, left = match([at('a.zip', problem='broken'), at('ada/notes.txt')], ASSIGNMENTS)
    assert [(each.reason, each.matters) for each in left] == [
        ('broken', True),
        ('neither a notebook nor Python', False),
    ]
