"""The owner of a file: the platform decides, not the file name that a student chose."""

import pytest
from incoming_files import ADA, ASSIGNMENTS, BLACKBOARD, MALLORY, arriving, owners

from grader.collect.matching import match


@pytest.fixture
def at(tmp_path):
    return arriving(tmp_path)


@pytest.mark.parametrize('folder', ['ws_2026_2027', 'ws_2026_2027_a', 'ros_2026_2026_b'])
def test_a_folder_of_a_term_is_not_taken_as_an_upload_of_canvas(folder, at):
    found = [at(f'{folder}/{who}/02_joint_state.ipynb') for who in ('ada', 'bob')]
    assert owners(*found) == ([('ada', '02_joint_state'), ('bob', '02_joint_state')], [])
    taken, ((_, why),) = owners(found[0])  # alone, the folder might be a student's
    assert (taken, why[:10]) == ([], 'it may be ')


@pytest.mark.parametrize('folder', ['kurs_101_202', 'kurs_101_202_b', 'ros_101_202', 'ros_12_345'])
@pytest.mark.parametrize('form', ['{0}/{1}.ipynb', '{0}_{1}.ipynb', '{0}_18151_21012_{1}.ipynb'])
def test_a_folder_of_a_class_with_numbers_is_not_taken_as_an_upload(folder, form, at):
    class_of_two = ('ada', '02_joint_state'), ('bob', '03_publisher')
    found = [at(f'{folder}/{form.format(*each)}') for each in class_of_two]
    assert owners(*found) == ([*class_of_two], [])


@pytest.mark.parametrize('folder', ['kurs_101_202', 'ros_101_202', 'ros_101_202_b', 'kurs_7_8'])
def test_a_class_folder_with_one_submission_is_not_taken_as_a_student(folder, at):
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
def test_an_unpacked_upload_of_canvas_belongs_to_its_student(inside, at):
    found = owners(at(f'ada_18151_21012_turtle/{inside}02_joint_state.ipynb'))
    assert found == ([('ada', '02_joint_state')], [])


UPLOADS = {
    'moodle': 'ada_1815_assignsubmission_file_/{}.zip/02_joint_state.ipynb',
    'moodle, flat': 'ada_1815_assignsubmission_file_{}.zip/02_joint_state.ipynb',
    'canvas': 'ada_18151_21012_{}.zip/02_joint_state.ipynb',
    'canvas, again': 'ada_LATE_18151_21012_{}-1.zip/02_joint_state.ipynb',
    'canvas, unpacked': 'ada_18151_21012_{}/02_joint_state.ipynb',
    'blackboard': 'Lab 2_ada_attempt_2026-01-02-03-04-05_{}.zip/02_joint_state.ipynb',
}


@pytest.mark.parametrize('upload', UPLOADS.values(), ids=UPLOADS)
def test_an_upload_under_another_students_name_is_left_to_a_person(upload, at):
    for own in ('ada', 'Ada', 'my homework', 'lab 3', '02_joint_state'):
        (taken,), left = match(
            [at(upload.format(own))], ASSIGNMENTS, students=['bob'], file_times=True
        )
        assert (taken.student_id, taken.remark, left) == ('ada', '', [])
    (taken,), left = match(
        [at(upload.format('turtle'))], ASSIGNMENTS, students=['bob'], file_times=True
    )
    assert (taken.remark, left) == ("from a folder of their own, 'turtle'", [])
    for others in ('bob', 'eve_02_joint_state'):
        taken, (left,) = match([at(upload.format(others))], ASSIGNMENTS, students=['bob'])
        assert taken == []
        assert f'handed in, under the name of {others[:3]}: if it is ada' in left.reason


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
    'Evil_Mallory_mallory_666/Ada Lovelace/03_publisher.ipynb',
    'Evil_Mallory_mallory_666/Ada Lovelace.zip/03_publisher.ipynb',
    'Evil_Mallory_mallory_666/Ada Lovelace_03_publisher.ipynb',
    'Evil_Mallory_mallory_666/work.zip/Lovelace_Ada_ada_4711/03_publisher.ipynb',
    'Evil_Mallory_mallory_666/Late Submission - Ada Lovelace_03_publisher.ipynb',
    f'{MALLORY}/Lovelace_Ada_ada_4711/03_publisher.ipynb',
    f'{MALLORY}work.zip/Lovelace_Ada_ada_4711/03_publisher.ipynb',
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
def test_a_file_with_a_forged_name_is_listed_and_replaces_no_other_work(path, at):
    hers, forged = at(HERS), at(path)
    taken, [(left, why)] = owners(hers, forged)
    assert taken == [('Ada Lovelace', '03_publisher')]
    assert left == path
    assert 'nothing tells' not in why


@pytest.mark.parametrize('path', FORGED)
def test_a_file_with_a_forged_name_is_not_assigned_to_a_known_student(path, at):
    taken, left = owners(at(path), students=['Ada Lovelace', 'Mallory Evil'])
    assert 'Ada Lovelace' not in {student for student, _ in taken}
    assert len(taken) + len(left) == 1


@pytest.mark.parametrize('path', FORGED)
@pytest.mark.parametrize('above', ['', 'ROS 2-Lab 3-4711/'])
def test_a_single_file_with_a_forged_name_is_not_assigned_to_that_student(above, path, at):
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
def test_a_students_own_name_is_accepted_in_any_spelling(path, at):
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
        ('Müller_Jörg_jmueller_4711/03_publisher.ipynb', 'Müller_Jörg'),
        ('King_Ada Maria_ada-m.k_4711/Ada Maria King.zip/03_publisher.ipynb', 'King_Ada Maria'),
        ('作业 3_小明_attempt_2026-01-02-03-04-05_03_publisher.ipynb', '小明'),
    ],
)
def test_names_of_every_alphabet_are_read_on_every_platform(path, student, at):
    (hand_in,), left = match([at(path)], ASSIGNMENTS)
    assert (hand_in.student_id, left) == (student, [])
    assert hand_in.label.number in path


def test_a_folder_named_after_no_known_student_is_taken_with_a_remark(at):
    (hand_in,), left = match([at(f'{ADA}/turtle-bot/03_publisher.ipynb')], ASSIGNMENTS)
    assert (hand_in.student_id, left) == ('Ada Lovelace', [])
    assert hand_in.remark == "from a folder of their own, 'turtle-bot'"


@pytest.mark.parametrize(
    'upload', ['carol.zip', 'carol.zip/class', 'Carol_7_assignsubmission_file_/work.zip']
)
@pytest.mark.parametrize('own', ['carol', 'Carol', 'carol_02_joint_state'])
@pytest.mark.parametrize('lesson', ['02_joint_state', '03_publisher'])
def test_a_folder_beside_the_student_s_own_one_is_not_taken_as_theirs(upload, own, lesson, at):
    hers, his = at(f'{upload}/{own}/02_joint_state.ipynb'), at(f'{upload}/dave/{lesson}.ipynb')
    other = at('erin.zip/03_publisher.ipynb')
    for among in ([], [other]):
        taken, [(left, why)] = owners(hers, his, *among)
        (who, assignment), *_ = taken
        assert (who.lower(), assignment, len(taken)) == ('carol', '02_joint_state', 1 + len(among))
        assert left == his.path
        assert f'has a folder {who}, and dave beside it: if dave is another student' in why
    apart = at(f'{own}/02_joint_state.ipynb'), at(f'dave/{lesson}.ipynb')  # as the reason says
    taken, left = owners(*apart)
    assert ([student.lower() for student, _ in taken], left) == (['carol', 'dave'], [])


def test_folders_of_a_student_s_own_are_taken_if_none_has_the_student_s_name(at):
    found = at('carol.zip/one/02_joint_state.ipynb'), at('carol.zip/two/03_publisher.ipynb')
    assert owners(*found) == ([('carol', '02_joint_state'), ('carol', '03_publisher')], [])


ILIAS = 'Lovelace_Ada_ada_4711', 'Babbage_Charles_cbabbage_4712'


@pytest.mark.parametrize(
    'form',
    [
        '{0}/{1}.ipynb',
        'Joint states/Abgaben/{0}/{1}.ipynb',
        '{1} of the week/Submissions/{0}/{1}.ipynb',
        'Joint states/Abgaben/Team {1}/{0}/{1}.ipynb',
        '{0}/Late Submission - {1}.ipynb',
        'Joint states/Abgaben/{0}/Verspatete Abgabe - {1} (2).ipynb',
        '{0}/work.zip/my work/{1}.ipynb',
        '{0}/Verspaetete Abgabe - {1}.zip/{1}.ipynb',
    ],
)
def test_students_are_found_in_the_download_of_all_submissions_of_ilias(form, at):
    lessons = '02_joint_state', '03_publisher'
    found = [at(form.format(*each)) for each in zip(ILIAS, lessons, strict=True)]
    students = [('Babbage_Charles', '03_publisher'), ('Lovelace_Ada', '02_joint_state')]
    assert owners(*found) == (students, [])
    assert owners(*found, students=['ada', 'Lovelace_Ada']) == (students, [])


@pytest.mark.parametrize(
    ('known', 'said'),
    [
        ([], 'known by this name from before, and keeps it; a new student would be Lovelace_Ada'),
        (
            ['Lovelace_Ada'],
            'known by this name and as Lovelace_Ada, and taken under this one: if ',
        ),
    ],
)
@pytest.mark.parametrize('inside', ['', 'work.zip/', 'ada_lovelace/', 'Ada Lovelace_'])
def test_a_student_known_by_the_whole_name_of_an_ilias_folder_keeps_it(inside, known, said, at):
    """As in a course that was collected before that form of names was known."""
    found = [at(f'{ILIAS[0]}/{inside}03_publisher.ipynb'), at(f'{ILIAS[1]}/03_publisher.ipynb')]
    hand_ins, left = match(found, ASSIGNMENTS, students=[ILIAS[0], *known])
    his, hers = hand_ins
    assert (his.student_id, his.remark) == ('Babbage_Charles', '')
    assert (hers.student_id, hers.label.number, left) == (ILIAS[0], '4711', [])
    assert hers.remark.startswith(said)


def test_a_namesake_of_a_student_with_an_earlier_name_is_another_student(at):
    found = [at(f'{who}/03_publisher.ipynb') for who in (ILIAS[0], 'Lovelace_Ada_a.l_4713')]
    taken, left = owners(*found, students=[ILIAS[0]])
    assert (taken, left) == ([('Lovelace_Ada', '03_publisher'), (ILIAS[0], '03_publisher')], [])


def test_files_that_come_late_in_ilias_keep_the_names_that_students_gave_them(at):
    late = f'{ILIAS[0]}/Late Submission - '
    files = [at(late + name) for name in ('02_joint_state.ipynb', 'helper.py')]
    package = at(f'{late}arm.zip/package.xml')
    needed = {'02_joint_state': ['arm']}
    (hand_in,), left = match([*files, package], ASSIGNMENTS, packages=needed)
    assert (sorted(hand_in.extra), left) == (['arm/package.xml', 'helper.py'], [])


@pytest.mark.parametrize('folder', ['ros_kurs_b_101', 'Robotik_Gruppe_A_2026', 'ros_ws_2026_101'])
def test_a_class_in_a_folder_named_as_in_ilias_is_not_taken_as_a_student(folder, at):
    taken, _ = owners(*(at(f'{folder}/{who}/03_publisher.ipynb') for who in ('ada', 'bob')))
    assert {student for student, _ in taken} <= {'ada', 'bob'}


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


def test_names_that_blackboard_leaves_unclear_are_left_to_a_person(at):
    paths = [BLACKBOARD.format(who, '09') for who in ('a_lovelace', 'b_lovelace', 'zoe')]
    taken, left = owners(*map(at, paths))
    assert taken == [('zoe', '02_joint_state')]
    assert [path for path, _ in left] == paths[:2]
    assert all('there are several lovelace' in why for _, why in left)


def test_a_student_is_found_in_two_assignments_of_blackboard(at):
    lab_3 = 'Lab 3_ada_attempt_2026-01-09-03-04-05_03_publisher.ipynb'
    taken, left = owners(at(BLACKBOARD.format('ada', '09')), at(lab_3))
    assert (taken, left) == ([('ada', '02_joint_state'), ('ada', '03_publisher')], [])


def test_the_reason_for_two_names_in_a_moodle_upload_names_the_uploader(at):
    path = 'Mallory_666_assignsubmission_file_/Ada_02_joint_state.ipynb'
    taken, [(_, reason)] = owners(at(path))
    assert taken == []
    assert reason.endswith("rename it if it is Mallory's, or else collect it by itself")


BOBS = 'Bob_7_assignsubmission_file_/02_joint_state.ipynb'


@pytest.mark.parametrize(
    'path',
    [
        f'{ADA}/answer.pdf',
        f'{ADA}/helper.py',
        'Ada Lovelace_1815_assignsubmission_onlinetext_/onlinetext.html',
        'Ada Lovelace_LATE_18151_21012_Untitled.docx',
        'Ada Lovelace+02_joint_state+2026-01-01 10:00:00 UTC/timestamp.txt',
    ],
)
def test_a_student_who_handed_in_no_notebook_is_named(path, at):
    (_,), [left] = match([at(BOBS), at(path)], ASSIGNMENTS)
    assert left.reason.startswith('there is no notebook in what Ada Lovelace handed in: ask for ')
    assert left.needs_attention
    _, [left] = match([at(BOBS), at(path)], ASSIGNMENTS, is_all=False)
    assert 'handed in' not in left.reason


@pytest.mark.parametrize(
    ('beside', 'problem'),
    [
        (f'{ADA}/02_joint_state.ipynb', ''),
        (f'{ADA}/Untitled.ipynb', ''),
        (f'{ADA}/work.zip', 'broken'),
    ],
)
def test_other_files_beside_a_notebook_or_beside_what_can_not_be_read_need_no_attention(
    beside, problem, at
):
    text = 'Ada Lovelace_1815_assignsubmission_onlinetext_/onlinetext.html'
    _, left = match([at(beside, problem=problem), at(text)], ASSIGNMENTS)
    assert [each.needs_attention for each in left if each.incoming.path == text] == [False]
