from datetime import UTC, datetime
from pathlib import Path

import pytest

from grader.collect.incoming import Incoming
from grader.collect.matching import match

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
        'Lab 2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'gradebook_ROS_Lab_2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'gradebook_ROS_Lab_2/Lab 2_ada_attempt_2026-01-02-03-04-05_02_joint_state.ipynb',
        'Lab 2_ada_attempt_2026-01-02-03-04-05_work.zip/02_joint_state.ipynb',
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


@pytest.mark.parametrize('folder', ['ws_2026_2027', 'ws_2026_2027_a', 'ros_2026_2026_b'])
def test_a_folder_of_a_term_is_no_upload_of_canvas(folder, at):
    found = [at(f'{folder}/{who}/02_joint_state.ipynb') for who in ('ada', 'bob')]
    assert owners(*found) == ([('ada', '02_joint_state'), ('bob', '02_joint_state')], [])
    taken, ((_, why),) = owners(found[0])  # nothing beside it says that it is no student
    assert (taken, why[:10]) == ([], 'it may be ')


@pytest.mark.parametrize('folder', ['kurs_101_202', 'kurs_101_202_b', 'ros_101_202', 'ros_12_345'])
@pytest.mark.parametrize('form', ['{0}/{1}.ipynb', '{0}_{1}.ipynb', '{0}_18151_21012_{1}.ipynb'])
def test_nor_is_one_of_a_class_with_numbers(folder, form, at):
    class_of_two = ('ada', '02_joint_state'), ('bob', '03_publisher')
    found = [at(f'{folder}/{form.format(*each)}') for each in class_of_two]
    assert owners(*found) == ([*class_of_two], [])


@pytest.mark.parametrize('folder', ['kurs_101_202', 'ros_101_202', 'ros_101_202_b', 'kurs_7_8'])
def test_no_class_is_a_student_because_one_of_it_handed_in(folder, at):
    for path in ('ada/02_joint_state.ipynb', 'ada.zip/02_joint_state.ipynb'):
        taken, _ = owners(at(f'{folder}/{path}'))
        assert {student for student, _ in taken} <= {'ada'}


def test_a_class_in_a_folder_like_an_unpacked_upload_is_left_to_a_person(at):
    taken, left = owners(
        at('ros_101_202_b/ada/02_joint_state.ipynb'), at('ros_101_202_b/bob/03_publisher.ipynb')
    )
    assert taken == []
    assert [why[:31] for _, why in left] == [
        'it may be of ros or of ada: col',
        'it may be of ros or of bob: col',
    ]


@pytest.mark.parametrize('inside', ['', 'notebooks/', 'turtle/', 'Ada/', '02_joint_state/'])
def test_an_upload_of_canvas_that_was_unpacked_is_its_student_s(inside, at):
    found = owners(at(f'ada_18151_21012_turtle/{inside}02_joint_state.ipynb'))
    assert found == ([('ada', '02_joint_state')], [])


@pytest.mark.parametrize(
    'path',
    [
        'Kurs ROS_101_assignsubmission_file_/ada/02_joint_state.ipynb',
        'ROS_Kurs_attempt_2026-01-02-03-04-05/ada/02_joint_state.ipynb',
        'kurs+02_joint_state+2026-01-01 10:00:00 UTC/02_joint_state.ipynb',
        'homework_02_joint_state.zip/02_joint_state.ipynb',
        'Hausaufgabe 2_02_joint_state.ipynb',
    ],
)
def test_a_word_for_work_or_a_class_is_no_student_whoever_wrote_it(path, at):
    taken, [(_, why)] = owners(at(path))
    assert taken == []
    assert 'names work or a class' in why


UPLOADS = {
    'moodle': 'ada_1815_assignsubmission_file_/{}.zip/02_joint_state.ipynb',
    'moodle, flat': 'ada_1815_assignsubmission_file_{}.zip/02_joint_state.ipynb',
    'canvas': 'ada_18151_21012_{}.zip/02_joint_state.ipynb',
    'canvas, again': 'ada_LATE_18151_21012_{}-1.zip/02_joint_state.ipynb',
    'canvas, unpacked': 'ada_18151_21012_{}/02_joint_state.ipynb',
    'blackboard': 'Lab 2_ada_attempt_2026-01-02-03-04-05_{}.zip/02_joint_state.ipynb',
}


@pytest.mark.parametrize('upload', UPLOADS.values(), ids=UPLOADS)
def test_an_upload_that_bears_another_name_is_told_to_a_person(upload, at):
    for own in ('ada', 'Ada', 'my homework', 'lab 3', '02_joint_state'):
        (taken,), left = match([at(upload.format(own))], ASSIGNMENTS, students=['bob'])
        assert (taken.student_id, taken.remark, left) == ('ada', '', [])
    (taken,), left = match([at(upload.format('turtle'))], ASSIGNMENTS, students=['bob'])
    assert (taken.remark, left) == ("from a folder of their own, 'turtle'", [])
    for others in ('bob', 'eve_02_joint_state'):
        taken, (left,) = match([at(upload.format(others))], ASSIGNMENTS, students=['bob'])
        assert taken == []
        assert f'handed in, under the name of {others[:3]}: if it is ada' in left.reason


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


# --- whose work it is: the platform decides, not the student -------------------------------------

MALLORY = 'Mallory Evil_666_assignsubmission_file_'
ADA = 'Ada Lovelace_1815_assignsubmission_file_'
HERS = f'{ADA}/03_publisher.ipynb'
HER_ATTEMPT = 'Lab 3_Ada Lovelace_attempt_2026-01-09-03-04-05'
FORGED = [
    f'{MALLORY}/Ada Lovelace.zip/03_publisher.ipynb',
    f'{MALLORY}/Ada Lovelace/03_publisher.ipynb',
    f'{MALLORY}/Ada Lovelace_03_publisher.ipynb',
    f'{MALLORY}/ada_lovelace/notebooks/03_publisher/03_publisher.ipynb',
    f'{MALLORY}/LovelaceAda/03_publisher.ipynb',
    f'{MALLORY}/Lovelace, Ada.zip/03_publisher.ipynb',
    f'{MALLORY}/homework.zip/Ada Lovelace/03_publisher.ipynb',
    f'{MALLORY}/homework.zip/Ada Lovelace.zip/03_publisher.ipynb',
    f'{MALLORY}/homework.zip/Ada Lovelace_03_publisher.ipynb',
    f'{MALLORY}/{ADA}/03_publisher.ipynb',
    f'{MALLORY}/{ADA}03_publisher.ipynb',
    f'{MALLORY}/work.zip/{ADA}/03_publisher.ipynb',
    f'{MALLORY}/Ada Lovelace_03_publisher/03_publisher.ipynb',
    f'{MALLORY}/Ada Lovelace+03_publisher+2020-01-01 00:00:00 UTC/03_publisher.ipynb',
    f'{MALLORY}/lovelaceada_18151_21012_03_publisher.ipynb',
    f'{MALLORY}Ada Lovelace_03_publisher.ipynb',
    f'{MALLORY}Ada Lovelace_1_assignsubmission_file_03_publisher.ipynb',
    f'{MALLORY}work.zip/Ada Lovelace/03_publisher.ipynb',
    'evilmallory_66666_77777_Ada Lovelace_03_publisher.ipynb',
    'evilmallory_66666_77777_homework.zip/Ada Lovelace/03_publisher.ipynb',
    'evilmallory_LATE_66666_77777_lovelaceada_18151_21012_03_publisher.ipynb',
    f'evilmallory_66666_77777_{HER_ATTEMPT}_03_publisher.ipynb',
    f'{MALLORY}{HER_ATTEMPT}_03_publisher.ipynb',
    f'Lab 3_evilmallory_attempt_2026-01-02-03-04-05_{HER_ATTEMPT}_03_publisher.ipynb',
    f'Lab 3_evilmallory_attempt_2026-01-02-03-04-05_work.zip/{HER_ATTEMPT}_03_publisher.ipynb',
    f'Lab 3_evilmallory_attempt_2026-01-02-03-04-05_{ADA}03_publisher.ipynb',
    'Lab 3_evilmallory_attempt_2026-01-02-03-04-05_Ada Lovelace_03_publisher.ipynb',
    'Mallory Evil/Ada Lovelace/03_publisher.ipynb',
    'Mallory Evil/Ada Lovelace.zip/03_publisher.ipynb',
    'Mallory Evil/Ada Lovelace_03_publisher.ipynb',
    f'Mallory Evil/{ADA}/03_publisher.ipynb',
    'Mallory Evil.zip/Ada Lovelace/03_publisher.ipynb',
    f'Mallory Evil.zip/{ADA}/03_publisher.ipynb',
    'mallory+03_publisher+2026-01-01 10:00:00 UTC/Ada Lovelace/03_publisher.ipynb',
    'mallory+03_publisher+2026-01-01 10:00:00 UTC/Ada Lovelace_03_publisher.ipynb',
]


@pytest.mark.parametrize('path', FORGED)
def test_what_a_student_named_is_listed_and_replaces_nobodys_work(path, at):
    hers, forged = at(HERS), at(path)
    taken, [(left, why)] = owners(hers, forged)
    assert taken == [('Ada Lovelace', '03_publisher')]
    assert left == path
    assert 'nothing tells' not in why


@pytest.mark.parametrize('path', FORGED)
def test_nor_does_it_where_ada_has_handed_in_before(path, at):
    taken, left = owners(at(path), students=['Ada Lovelace', 'Mallory Evil'])
    assert 'Ada Lovelace' not in {student for student, _ in taken}
    assert len(taken) + len(left) == 1


@pytest.mark.parametrize('path', FORGED)
@pytest.mark.parametrize('above', ['', 'ROS 2-Lab 3-4711/'])
def test_nor_alone_in_a_download(above, path, at):
    if path == f'Mallory Evil/{ADA}/03_publisher.ipynb':
        path = f'Mallory Evil.zip/{ADA}/03_publisher.ipynb'  # a folder may be the teacher's
    taken, left = owners(at(above + path))
    assert {student for student, _ in taken}.isdisjoint({'Ada Lovelace', 'lovelaceada'})
    assert len(taken) + len(left) == 1


@pytest.mark.parametrize(
    'path',
    [
        f'{ADA}/Ada Lovelace.zip/03_publisher.ipynb',
        f'{ADA}/ada lovelace/03_publisher.ipynb',
        f'{ADA}/Lovelace Ada_03_publisher.ipynb',
        f'{ADA}/LOVELACE_ADA.zip/notebooks/03_publisher/03_publisher.ipynb',
        f'{ADA}/lovelaceada/03_publisher.ipynb',
        f'{ADA}/homework.zip/homework/03_publisher.ipynb',
        f'{ADA}/my homework (2).zip/03_publisher.ipynb',
        f'{ADA}03_publisher.ipynb',
        f'{ADA}ada_lovelace_03_publisher.ipynb',
        f'{ADA}homework.zip/03_publisher.ipynb',
        f'Lab 3/{ADA}/03_publisher.ipynb',
        f'ROS 2-Lab 3-4711/{ADA}/03_publisher.ipynb',
        'Ada Lovelace_1815_assignsubmission_file/03_publisher.ipynb',
        'Ada Lovelace.zip/lovelace_ada/03_publisher.ipynb',
        'Ada Lovelace/Ada Lovelace/03_publisher.ipynb',
        'Ada Lovelace (1).zip/03_publisher.ipynb',
    ],
)
def test_a_student_s_own_name_in_any_spelling_is_fine(path, at):
    (hand_in,), left = match([at(path)], ASSIGNMENTS)
    assert (hand_in.student_id, hand_in.assignment) == ('Ada Lovelace', '03_publisher')
    assert (hand_in.remark, left) == ('', [])


@pytest.mark.parametrize(
    ('path', 'student'),
    [
        ('王小明_7_assignsubmission_file_/小明王.zip/03_publisher.ipynb', '王小明'),
        ('Jörg Müller_7_assignsubmission_file_/jorg_muller/03_publisher.ipynb', 'Jörg Müller'),
        ('müllerjörg_LATE_71717_81818_Jörg Müller_03_publisher-3.ipynb', 'müllerjörg'),
        ('müllerjörg_71717_81818_homework-1.zip/03_publisher.ipynb', 'müllerjörg'),
        ('Participant_123_assignsubmission_file_/03_publisher.ipynb', 'Participant 123'),
        ('作业 3_小明_attempt_2026-01-02-03-04-05_03_publisher.ipynb', '小明'),
    ],
)
def test_names_of_every_alphabet_on_every_platform(path, student, at):
    (hand_in,), left = match([at(path)], ASSIGNMENTS)
    assert (hand_in.student_id, left) == (student, [])
    assert hand_in.label.number in path


def test_a_folder_named_after_nobody_known_is_taken_and_told(at):
    (hand_in,), left = match([at(f'{ADA}/turtle-bot/03_publisher.ipynb')], ASSIGNMENTS)
    assert (hand_in.student_id, left) == ('Ada Lovelace', [])
    assert hand_in.remark == "from a folder of their own, 'turtle-bot'"


@pytest.mark.parametrize('wrapper', ['', 'download/'])
def test_equal_names_with_different_numbers_are_left_to_a_person(wrapper, at):
    path = wrapper + 'Ada Lovelace_{}_assignsubmission_file_/{}.ipynb'
    two = at(path.format(1, '02_joint_state')), at(path.format(2, '03_publisher'))
    bob = at(wrapper + 'Bob_3_assignsubmission_file_/03_publisher.ipynb')
    taken, left = owners(*two, bob)
    assert taken == [('Bob', '03_publisher')]
    assert [path for path, _ in left] == [each.path for each in two]
    assert all('several Ada Lovelace with different numbers' in why for _, why in left)


def test_a_student_has_another_number_in_each_of_moodle_s_assignments(at):
    path = 'Lab {0}/Ada Lovelace_10{0}_assignsubmission_file_/{1}.ipynb'
    taken, left = owners(at(path.format(2, '02_joint_state')), at(path.format(3, '03_publisher')))
    assert taken == [('Ada Lovelace', '02_joint_state'), ('Ada Lovelace', '03_publisher')]
    assert left == []


BLACKBOARD = 'Lab 2_{}_attempt_2026-01-{}-03-04-05_02_joint_state.ipynb'


def test_blackboard_says_which_attempt_is_the_latest(at):
    attempts = [at(BLACKBOARD.format('ada', day), day) for day in ('10', '09', '11')]
    hand_ins, left = match(attempts, ASSIGNMENTS)
    assert [each.notebook for each in hand_ins] == [attempts[1], attempts[0], attempts[2]]
    assert left == []
    # the platform's clock is taken to be this machine's
    local = hand_ins[0].handed_in.astimezone()
    assert local.strftime('%m-%d %H:%M:%S') == '01-09 03:04:05'


def test_a_time_that_is_none_is_left_out(at):
    assert time_of(at(BLACKBOARD.format('ada', '41'))) == (None, [])


def test_names_that_blackboard_leaves_unclear_are_left_to_a_person(at):
    paths = [BLACKBOARD.format(who, '09') for who in ('a_lovelace', 'b_lovelace', 'zoe')]
    taken, left = owners(*map(at, paths))
    assert taken == [('zoe', '02_joint_state')]
    assert [path for path, _ in left] == paths[:2]
    assert all('there are several lovelace' in why for _, why in left)


def test_a_name_stands_before_another_assignment_of_blackboard_s(at):
    lab_3 = 'Lab 3_ada_attempt_2026-01-09-03-04-05_03_publisher.ipynb'
    taken, left = owners(at(BLACKBOARD.format('ada', '09')), at(lab_3))
    assert (taken, left) == ([('ada', '02_joint_state'), ('ada', '03_publisher')], [])


def test_two_homeworks_are_not_one_student(at):
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


def test_a_class_beside_other_files_is_read_as_before(at):
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


def test_where_two_folders_may_be_the_student_s_a_person_decides(at):
    paths = 'CS101/ada/03_publisher.ipynb', 'CS102/bob/03_publisher.ipynb'
    taken, left = owners(*map(at, paths))
    assert taken == []
    assert [why[:27] for _, why in left] == [
        'it may be of CS101 or of ad',
        'it may be of CS102 or of bo',
    ]


@pytest.mark.parametrize(
    'upload', [ADA, 'lovelaceada_18151_21012_homework.zip', f'{ADA}/homework.zip']
)
@pytest.mark.parametrize('inside', ['', '/ada lovelace'])
def test_a_time_that_a_student_uploaded_is_not_believed(upload, inside, at):
    notebook = at(f'{upload}{inside}/03_publisher.ipynb')
    stamp = at(f'{upload}{inside}/timestamp.txt', '2020-01-01 00:00:00 UTC')
    when, [why] = time_of(notebook, stamp)
    assert when is None
    assert 'is not believed' in why
    assert time_of(notebook, stamp, file_times=True)[0] == '01-01 12:00:00'


@pytest.mark.parametrize('upload', [ADA, 'ada lovelace.zip', f'{ADA}/homework.zip'])
def test_nor_one_in_the_name_of_a_folder_in_the_exchange_s_form(upload, at):
    folder = f'{upload}/Ada Lovelace+03_publisher+2020-01-01 00:00:00 UTC'
    for options, when in (({}, None), ({'file_times': True}, '01-01 12:00:00')):
        assert time_of(at(f'{folder}/03_publisher.ipynb'), **options) == (when, [])


def test_what_moodle_gives_out_says_which_of_two_names_counts(at):
    path = 'Mallory_666_assignsubmission_file_/Ada_02_joint_state.ipynb'
    taken, [(_, reason)] = owners(at(path))
    assert taken == []
    assert reason.endswith("rename it if it is Mallory's, or else collect it by itself")


@pytest.mark.parametrize('name', ['fay_03_Publisher.ipynb', '03_publisher_fay.ipynb'])
def test_a_name_that_is_nearly_right_is_told_its_assignment_alone(name):
    _, [left] = match([Incoming((name,), Path(name))], ['02_joint_state', '03_publisher'])
    assert left.reason.startswith('named after no assignment: expected STUDENT_ASSIGNMENT.ipynb')
    assert left.reason.endswith('with 03_publisher')
