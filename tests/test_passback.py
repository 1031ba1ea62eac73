"""Scores for a course platform have the form that it imports; messages name who is left out."""

import csv
import json
import zipfile

import pytest
from course_maker import TOY, answered, executed, released_course, submit

from grader.__main__ import main
from grader.collect.platforms import label_in
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.passback import write
from grader.passback.final_scores import final_scores
from grader.storage.gradebook import store
from grader.storage.pipeline import sanitize_restored
from grader.storage.records import CellScore


def cell(student, score, most=3.0, *, submitted=True, name='check', assignment='03_publisher'):
    return CellScore(student, assignment, name, score, most, submitted=submitted)


CLASS = [
    cell('Ada Lovelace', 2.5),
    cell('Ada Lovelace', 2.0, 2.0, name='stamp'),
    cell('Ada Lovelace', -1.0, 0.0, name='late_penalty'),
    cell('Bob', 0.0),
    cell('Bob', 1.0, 2.0, name='stamp'),
    cell('Cleo', 3.0),
    cell('Cleo', None, 2.0, name='stamp'),
    cell('Dan', None, submitted=False),
    cell('王 小明', 3.0),
    cell('王 小明', 2.0, 2.0, name='stamp'),
]
NUMBERS = {
    'Ada Lovelace': {'03_publisher': {'moodle': '8001', 'canvas': '18151'}},
    '王 小明': {'03_publisher': {'moodle': '8003', 'canvas': '18153'}},
}


@pytest.fixture
def course(tmp_path, monkeypatch):
    course = released_course(tmp_path)
    course.gradebook.mkdir(exist_ok=True)
    (course.gradebook / 'numbers.json').write_text(json.dumps(NUMBERS), encoding='utf-8')
    monkeypatch.setattr(write, 'records', lambda course: CLASS)
    return course


@pytest.fixture
def roster(tmp_path):
    def write_roster(*lines):
        path = tmp_path / 'roster.csv'
        path.write_text('\n'.join(lines), encoding='utf-8-sig')
        return path

    return write_roster


def table(path):
    return list(csv.reader(path.read_text(encoding='utf-8-sig').splitlines()))


def moodle(course, *arguments):
    main(['scores', '03_publisher', '--format', 'moodle', *map(str, arguments)], course=course)
    return table(course.gradebook / 'moodle' / '03_publisher.csv')


def canvas(course, *arguments):
    main(['scores', '--format', 'canvas', *map(str, arguments)], course=course)
    return table(course.gradebook / 'canvas' / '03_publisher.csv')


def test_a_sum_of_tenths_has_no_rounding_error():
    (scores,) = final_scores(cell('ada', score, name=str(score)) for score in (0.7, 0.1, 0.1))
    assert scores.final[0].score == 0.9


def test_a_score_is_final_once_no_person_has_to_decide():
    (scores,) = final_scores(CLASS)
    assert [(each.student_id, each.score, each.max_score) for each in scores.final] == [
        ('Ada Lovelace', 3.5, 5.0),
        ('Bob', 1.0, 5.0),
        ('王 小明', 5.0, 5.0),
    ]
    assert scores.waiting == ('Cleo',)
    assert final_scores(CLASS, '04_subscriber') == []


def test_moodles_worksheet_needs_no_roster_where_the_numbers_came_with_the_submissions(
    course, capsys
):
    assert moodle(course) == [
        ['Identifier', 'Full name', 'Grade', 'Last modified (grade)'],
        ['Participant 8001', 'Ada Lovelace', '3.5', '-'],
        ['Participant 8003', '王 小明', '5.0', '-'],
    ]
    said = capsys.readouterr().out
    assert '03_publisher: Cleo needs manual grading in the formgrader' in said
    assert (
        '03_publisher: Bob has no Moodle number: only work collected from '
        '*Download all submissions* has one. Enter this score by hand, or use --roster FILE.\n'
    ) in said
    assert 'Dan' not in said


def test_moodles_own_worksheet_keeps_its_columns_and_missing_rows_are_reported(
    course, roster, capsys
):
    head = 'Identifier,Full name,Email address,Grade,Maximum Grade,Last modified (grade)'
    rows = moodle(
        course,
        '--roster',
        roster(
            head,
            'Participant 8001,"Lovelace, A.",ada@x.org,,5.00,"Monday, 9:00 AM"',
            'Participant 8002,bob,bob@x.org,4.00,5.00,-',
            'Participant 8009,Somebody Else,e@x.org,,5.00,-',
        ),
    )
    assert rows == [
        head.split(','),
        ['Participant 8001', 'Lovelace, A.', 'ada@x.org', '3.5', '5.00', 'Monday, 9:00 AM'],
        ['Participant 8002', 'bob', 'bob@x.org', '1.0', '5.00', '-'],
    ]
    assert (
        '王 小明 has the number 8003, which no row of roster.csv has: expected the table of this '
        'course and assignment; export it again, or give this score by hand'
    ) in capsys.readouterr().out


@pytest.mark.parametrize(
    ('platform', 'lines'),
    [
        (
            'moodle',
            [
                'Identifier,Full name,Grade,Maximum Grade,Last modified (grade)',
                'Participant 9001,Ada Lovelace,,5.00,-',
                'Participant 9002,Bob,,5.00,-',
            ],
        ),
        ('canvas', ['Student,ID,Section', '"Lovelace, Ada",99,', 'Bob,98,']),
    ],
)
def test_a_row_of_the_same_name_and_another_number_is_not_the_students(
    platform, lines, course, roster, capsys
):
    """It is a namesake's, or the worksheet is of another assignment."""
    export = {'moodle': moodle, 'canvas': canvas}[platform]
    _, *rows = export(course, '--roster', roster(*lines))
    assert [row for row in rows if 'Bob' not in row] == []
    assert len(rows) == 1
    assert 'Ada Lovelace has the number ' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('heading', 'value'), [('Scale', ''), ('Points', '100.00'), ('Maximum grade', 'Pass, fail')]
)
def test_a_worksheet_that_does_not_show_the_maximum_is_reported_once(
    heading, value, course, roster, capsys
):
    rows = moodle(
        course,
        '--roster',
        roster(
            f'Identifier,Full name,Grade,{heading},Last modified (grade)',
            f'Participant 8001,Ada,,"{value}",-',
            f'Participant 8002,Bob,,"{value}",-',
        ),
    )
    assert [row[2] for row in rows[1:]] == ['3.5', '1.0']
    said = capsys.readouterr().out
    assert said.count('check that its maximum grade is 5 there before you upload the file') == 1


def test_the_canvas_file_has_the_columns_up_to_the_section_and_the_scores(course, roster, capsys):
    rows = canvas(
        course,
        '--roster',
        roster(
            'Student,ID,SIS User ID,SIS Login ID,Section,02_joint_state (70),03_publisher (71)',
            '    Points Possible,,,,,2,5',
            '"Lovelace, Ada",18151,s1,ada,A,1,',
            '"Bob",18152,s2,bob,B,2,5',
            '"小明, 王",18153,s3,wang,B,2,',
        ),
    )
    assert rows == [
        ['Student', 'ID', 'SIS User ID', 'SIS Login ID', 'Section', '03_publisher (71)'],
        ['Lovelace, Ada', '18151', 's1', 'ada', 'A', '3.5'],
        ['Bob', '18152', 's2', 'bob', 'B', '1.0'],
        ['小明, 王', '18153', 's3', 'wang', 'B', '5.0'],
    ]
    assert 'Bob' not in capsys.readouterr().out


def test_a_row_that_ends_early_has_empty_last_columns(course, roster):
    """As if a roster was edited by hand: a spreadsheet leaves out empty cells."""
    canvas_rows = canvas(
        course, '--roster', roster('Student,ID,Section', 'Class of 2026', 'Bob,2')
    )
    assert canvas_rows == [['Student', 'ID', 'Section', '03_publisher'], ['Bob', '2', '', '1.0']]
    head = 'Identifier,Full name,Grade,Last modified (grade)'
    moodle_rows = moodle(course, '--roster', roster(head, 'A note', 'Participant 8002,Bob'))
    assert moodle_rows == [head.split(','), ['Participant 8002', 'Bob', '1.0', '']]


def test_an_assignment_of_another_name_in_canvas_is_reported_with_what_to_do(
    course, roster, capsys
):
    rows = canvas(
        course,
        '--roster',
        roster(
            'Student,ID,SIS Login ID,Section,Lab 3: Publisher (71),Lab 4 (72),Final Score',
            'Bob,18152,bob,B,,,',
        ),
    )
    assert rows[0] == ['Student', 'ID', 'SIS Login ID', 'Section', '03_publisher']
    assert (
        "03_publisher: roster.csv has no column '03_publisher (NUMBER)'. Its assignments: 'Lab 3: "
        "Publisher (71)', 'Lab 4 (72)'. If one of them is meant, rename it to 03_publisher in "
        'Canvas, export the gradebook again, and repeat this command'
    ) in capsys.readouterr().out


def test_many_assignments_of_other_names_are_not_all_listed(course, roster, capsys):
    labs = ','.join(f'Lab {number} ({number})' for number in range(100))
    canvas(course, '--roster', roster(f'Student,ID,Section,{labs}', 'Bob,18152,B'))
    said = capsys.readouterr().out
    assert "'Lab 19 (19)' and 80 more." in said
    assert 'Lab 20' not in said


def test_the_canvas_file_without_a_roster_uses_the_collected_numbers(course, capsys):
    assert canvas(course) == [
        ['Student', 'ID', 'Section', '03_publisher'],
        ['Ada Lovelace', '18151', '', '3.5'],
        ['王 小明', '18153', '', '5.0'],
    ]
    assert (
        '03_publisher: Bob has no Canvas number: only work collected from '
        '*Download submissions* has one. Enter this score by hand, or use --roster FILE.\n'
    ) in capsys.readouterr().out


def test_no_file_is_written_if_no_student_has_a_number_of_the_platform(course, capsys):
    (course.gradebook / 'numbers.json').unlink()
    assert main(['scores', '--format', 'canvas'], course=course) == 0
    captured = capsys.readouterr()
    assert captured.out.count('has no Canvas number') == 3
    assert 'No file was written' in captured.err
    assert not (course.gradebook / 'canvas').exists()


def test_two_rows_of_one_name_or_two_students_of_one_row_are_left_to_a_person(
    course, roster, capsys, monkeypatch
):
    scores = {'Ann': 4.0, 'bob': 1.0, 'Bob': 2.0, 'Eve': 3.0}
    monkeypatch.setattr(write, 'records', lambda course: [cell(*each) for each in scores.items()])
    lines = 'Student,ID,Section', 'Ann,4,', 'Bob,1,', 'Eve,2,', 'Eve,3,'
    rows = canvas(course, '--roster', roster(*lines))
    assert [row[0] for row in rows] == ['Student', 'Ann']
    said = capsys.readouterr().out
    assert 'Eve has several rows in roster.csv' in said
    assert 'bob has a row that may also be of another student in roster.csv' in said


@pytest.mark.parametrize(
    ('platform', 'lines', 'said'),
    [
        ('moodle', ['ID,Vorname', '1,Ada'], "has no column 'Identifier', 'Full name'"),
        ('moodle', [''], "has no column 'Identifier'"),
        ('canvas', ['Student,ID,ID,Section'], 'has two columns of the same name'),
        (
            'canvas',
            ['Name,ID,Section,03_publisher (7)', 'Ada,18151,,'],
            "no column 'Student'. Found: 'Name', 'ID', 'Section', '03_publisher (7)'. Take the g",
        ),
        ('canvas', [''], "has no column 'Student', 'ID', 'Section'. Found: none. Take the g"),
        (
            'canvas',
            ['Student,ID,Section,03_publisher (7),03_Publisher (8)', 'Ada,18151,,,'],
            "has several columns for 03_publisher: '03_publisher (7)', '03_Publisher (8)'.",
        ),
        ('canvas', ['Student,ID,Section', '"Ada,1,'], 'is not a CSV table'),
        (
            'moodle',
            [
                'Identifier,Full name,Grade,Maximum Grade,Last modified (grade)',
                'Participant 8001,Ada,,100.00,-',
            ],
            'gives in Moodle is 100, and 03_publisher gives 5: set its maximum grade to 5',
        ),
        (
            'moodle',  # as other versions of Moodle write it, after a spreadsheet saved it
            [
                'Identifier;Full name;Grade;Maximum grade;Last modified (grade)',
                'Participant 8001;Ada;;100,00;-',
            ],
            'gives in Moodle is 100, and 03_publisher gives 5: set its maximum grade to 5',
        ),
        (
            'canvas',
            ['Student,ID,Section,03_publisher (7)', 'Points Possible,,,10', 'Ada,18151,,'],
            '03_publisher (7) gives 10 points in Canvas and 5 here',
        ),
        (
            'canvas',  # saved by a spreadsheet with commas in numbers
            [
                'Student;ID;Section;03_publisher (7)',
                'Points Possible;;;10,00',
                'Ada;18151;;',
            ],
            '03_publisher (7) gives 10 points in Canvas and 5 here',
        ),
    ],
)
def test_a_roster_that_does_not_fit_is_refused_in_a_sentence(
    platform, lines, said, course, roster, capsys
):
    arguments = ['scores', '03_publisher', '--format', platform, '--roster', str(roster(*lines))]
    assert main(arguments, course=course) != 0
    assert said in capsys.readouterr().err
    assert not list(course.gradebook.glob(f'{platform}/*'))


@pytest.mark.parametrize(
    ('arguments', 'said'),
    [
        (['03_publisher'], 'say which one, as in ./course scores --format moodle'),
        (['--roster', 'x.csv'], 'say which one'),
        (['--format', 'moodle', '--roster', 'x.csv'], 'is of one assignment'),
        ([TOY, '--format', 'canvas'], f'nothing of {TOY} is graded yet'),
        (
            ['03_publisher', '--format', 'canvas', '--roster', '/nowhere'],
            'cannot be read: No such',
        ),
    ],
)
def test_arguments_that_do_not_suffice_for_an_export_are_reported(arguments, said, course, capsys):
    assert main(['scores', *arguments], course=course) != 0
    assert said in capsys.readouterr().err


def test_a_name_starts_no_formula_in_a_spreadsheet(course, monkeypatch):
    numbers = {'=cmd()': {'03_publisher': {'moodle': '8001'}}}
    (course.gradebook / 'numbers.json').write_text(json.dumps(numbers))
    monkeypatch.setattr(write, 'records', lambda course: [cell('=cmd()', 1.0)])
    assert moodle(course)[1] == ['Participant 8001', "'=cmd()", '1.0', '-']


def test_feedback_goes_back_under_the_names_that_moodle_gave_out(course, capsys):
    for student in ('Ada Lovelace', 'Bob', '王 小明'):
        page = course.folder('feedback', student, '03_publisher') / '03_publisher.html'
        page.parent.mkdir(parents=True)
        page.write_text(f'<p>{student}</p>')
    assert main(['feedback', '--zip', 'moodle'], course=course) == 0
    said = capsys.readouterr().out
    assert (
        '03_publisher: Bob has no Moodle number, so no archive has that page: only work '
        'collected from *Download all submissions* has one.\n'
    ) in said
    with zipfile.ZipFile(course.gradebook / 'moodle' / '03_publisher-feedback.zip') as archive:
        names = archive.namelist()
        assert archive.read(names[0]).decode() == '<p>Ada Lovelace</p>'
    labels = [label_in(name) for name in names]
    assert [(each.student, each.number, each.rest) for each in labels] == [
        ('Ada Lovelace', '8001', '03_publisher.html'),
        ('王 小明', '8003', '03_publisher.html'),
    ]
    # as Moodle takes a name apart
    assert names[0].split('_', 4)[1:4] == ['8001', 'assignsubmission', 'file']


@pytest.mark.parametrize('asked', [['scores', '--format'], ['feedback', '--zip']])
def test_a_message_says_that_no_file_was_written(tmp_path, capsys, asked):
    course = released_course(tmp_path)
    assert main([*asked, 'moodle'], course=course) == 0
    said = capsys.readouterr()
    assert '\n\n' not in f'\n{said.out}'
    assert said.err.splitlines() == [
        'No file was written: there is nothing to put into one.',
        'Nothing is graded yet. Next: ./course grade',
    ]


def test_an_underscore_in_a_name_does_not_shift_the_number():
    name = write.moodle.name_feedback_file('ada_lovelace', '8001', '03_publisher')
    assert name.split('_', 4)[1:] == ['8001', 'assignsubmission', 'file', '03_publisher.html']


def test_a_download_of_moodle_is_collected_graded_and_exported(tmp_path, capsys):
    course = released_course(tmp_path)
    submit(course, 'x', answered(course, 'def double(x):\n    return x + x'))
    taken = course.folder('submitted', 'x', TOY)
    source = tmp_path / 'download' / 'Ada Lovelace_8001_assignsubmission_file_'
    source.mkdir(parents=True)
    (taken / f'{TOY}.ipynb').rename(source / f'{TOY}.ipynb')
    taken.rmdir()
    taken.parent.rmdir()
    assert main(['collect', str(source.parent)], course=course) == 0
    folder = course.folder('submitted', 'Ada Lovelace', TOY)
    submission = read_submission(folder, student_id='Ada Lovelace', assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    stored = store(course, submission, executed(sanitize_restored(course, TOY, restored), {}))
    capsys.readouterr()
    assert main(['scores', '--format', 'moodle'], course=course) == 0
    path = course.gradebook / 'moodle' / f'{TOY}.csv'
    assert str(path) in capsys.readouterr().out
    assert table(path)[1] == ['Participant 8001', 'Ada Lovelace', str(stored.score), '-']
