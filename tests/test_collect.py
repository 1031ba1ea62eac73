import csv
import gzip
import json
import os
import shutil
import tarfile
import tracemalloc
import zipfile
from datetime import datetime
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, executed, released_course
from nbgrader.coursedir import CourseDirectory

from grader.__main__ import main
from grader.collect import collect as module
from grader.collect import uploads
from grader.collect.collect import AGAIN, EARLIER, KNOWN, LEFT, NEW, UNUSED, collect
from grader.common.errors import CourseError
from grader.common.parsing import Limits
from grader.course import Course
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.gradebook import store
from grader.storage.pipeline import prepare
from grader.storage.registering import register
from grader.storage.submitted import find_submissions

NOTEBOOK = f'{TOY}.ipynb'
RIGHT, WRONG = 'def double(x):\n    return 2 * x', 'def double(x):\n    return x'


@pytest.fixture(scope='module')
def released(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('collect'))


@pytest.fixture
def course(released, tmp_path):
    return Course(root=released.root, gradebook=tmp_path / 'gradebook')


@pytest.fixture
def source(tmp_path):
    folder = tmp_path / 'came in'
    folder.mkdir()
    return folder


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content)


def rows(course, source, **options):
    """What became of each file: outcome by path."""
    return {row.path: row.outcome for row in collect(course, source, **options)}


def tree(folder):
    """All that lies in a folder: each file's path and content."""
    found = sorted(path for path in folder.rglob('*') if path.is_file())
    return {str(path.relative_to(folder)): path.read_text() for path in found}


def submitted(course, student='ada'):
    return tree(course.folder('submitted', student, TOY))


def before(course, student='ada'):
    return tree(course.folder('submitted_before', student, TOY))


def exchanged(source, day, content):
    folder = source / f'ada+{TOY}+2026-01-0{day} 10:00:00.000000 UTC'
    write(folder / NOTEBOOK, content)
    write(folder / 'timestamp.txt', f'2026-01-0{day} 10:00:00.000000 UTC')


def test_what_came_in_lies_where_it_is_graded(course, source):
    write(source / f'ada_{TOY}.ipynb', 'ada’s')
    write(source / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    write(source / f'bob/{TOY}/helper.py', 'x = 1')
    write(source / f'bob/{TOY}/timestamp.txt', '2026-01-01 12:00:00 CET')
    write(source / 'whose.ipynb', '')
    write(source / 'notes.txt', '')
    untouched = tree(source)
    assert rows(course, source) == {
        f'ada_{TOY}.ipynb': NEW,
        f'bob/{TOY}/{NOTEBOOK}': NEW,
        'whose.ipynb': LEFT,
        'notes.txt': UNUSED,
    }
    assert submitted(course) == {NOTEBOOK: 'ada’s'}
    assert submitted(course, 'bob') == {
        NOTEBOOK: 'bob’s',
        'helper.py': 'x = 1',
        'timestamp.txt': '2026-01-01 11:00:00.000000 UTC',
    }
    assert tree(source) == untouched
    assert [each.problem for each in find_submissions(course)] == ['', '']


def test_doing_it_again_changes_nothing(course, source):
    for day in (1, 2, 3):
        exchanged(source, day, f'version {day}')
    write(source / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    assert set(rows(course, source).values()) == {NEW, AGAIN}
    first = tree(course.gradebook)
    assert submitted(course)[NOTEBOOK] == 'version 3'
    assert [before(course)[f'{n}/submitted/{NOTEBOOK}'] for n in (1, 2)] == [
        'version 1',
        'version 2',
    ]
    for _ in range(2):
        assert set(rows(course, source).values()) == {KNOWN}
        assert tree(course.gradebook) == first


def test_a_later_one_counts_and_the_earlier_is_kept_with_its_time(course, source):
    exchanged(source, 1, 'first')
    rows(course, source)
    exchanged(source, 2, 'second')
    assert sorted(rows(course, source).values()) == [AGAIN, KNOWN]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert submitted(course)['timestamp.txt'].startswith('2026-01-02')
    assert before(course) == {
        f'1/submitted/{NOTEBOOK}': 'first',
        '1/submitted/timestamp.txt': '2026-01-01 10:00:00.000000 UTC',
    }


def test_an_earlier_one_that_comes_late_is_kept_and_does_not_count(course, source, tmp_path):
    exchanged(source, 2, 'second')
    rows(course, source)
    exchanged(tmp_path / 'mail', 1, 'first')
    assert list(rows(course, tmp_path / 'mail').values()) == [EARLIER]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert before(course)[f'1/submitted/{NOTEBOOK}'] == 'first'
    assert list(rows(course, tmp_path / 'mail').values()) == [KNOWN]


def test_without_times_what_comes_later_is_later(course, source):
    for version in ('one', 'two'):
        write(source / f'ada_{TOY}.ipynb', version)
        rows(course, source)
    assert submitted(course) == {NOTEBOOK: 'two'}
    assert before(course) == {f'1/submitted/{NOTEBOOK}': 'one'}
    write(source / f'ada_{TOY}.ipynb', 'one')
    assert rows(course, source) == {f'ada_{TOY}.ipynb': KNOWN}
    assert submitted(course) == {NOTEBOOK: 'two'}


def test_who_goes_back_to_a_former_version_later_is_graded_by_it(course, source):
    for day, content in ((1, 'good'), (2, 'bad'), (3, 'good')):
        exchanged(source, day, content)
        rows(course, source)
    assert submitted(course)[NOTEBOOK] == 'good'
    assert before(course)[f'2/submitted/{NOTEBOOK}'] == 'bad'


def test_a_changed_helper_is_another_submission(course, source):
    write(source / f'ada/{NOTEBOOK}', 'same')
    rows(course, source)
    write(source / 'ada/helper.py', 'x = 1')
    assert rows(course, source) == {f'ada/{NOTEBOOK}': AGAIN}


def test_the_earlier_one_keeps_its_grade(course, source):
    write(source / f'ada_{TOY}.ipynb', '')
    for answer, reasons in ((WRONG, {'double-check': 'expected 2, saw 1'}), (RIGHT, {})):
        notebook = answered(course, answer)
        (source / f'ada_{TOY}.ipynb').write_text(nbformat.writes(notebook))
        rows(course, source)
        register(course, TOY)
        folder = course.folder('submitted', 'ada', TOY)
        submission = read_submission(folder, student_id='ada', assignment=TOY)
        restored = restore(submission.notebook, course.template(TOY)).notebook
        store(course, submission, executed(prepare(course, TOY, restored), reasons))
    kept = course.folder('submitted_before', 'ada', TOY) / '1'
    assert sorted(path.name for path in kept.iterdir()) == [
        'autograded',
        'scores.csv',
        'submitted',
    ]
    table = {
        row['grade_id']: row
        for row in csv.DictReader((kept / 'scores.csv').open(encoding='utf-8-sig'))
    }
    assert (table['double-check']['score'], table['double-hidden']['score']) == ('0.0', '2.0')
    assert table['double-check']['comment'] == 'expected 2, saw 1'
    assert WRONG.splitlines()[1].strip() in (kept / 'autograded' / NOTEBOOK).read_text()


@pytest.mark.parametrize('survived', range(5))
def test_a_run_that_ended_half_way_loses_nothing_and_goes_on(
    survived, course, source, monkeypatch
):
    for day in (1, 2):
        exchanged(source, day, f'version {day}')
    rename, calls = Path.rename, []

    def dies(path, target):
        calls.append(path)
        if len(calls) > survived:
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, 'rename', dies)
    if survived < 4:  # new, one to the shelf, two to replace it
        with pytest.raises(KeyboardInterrupt):
            rows(course, source)
    else:
        rows(course, source)
    monkeypatch.undo()
    rows(course, source)
    assert submitted(course)[NOTEBOOK] == 'version 2'
    kept = {path: text for path, text in before(course).items() if path.endswith('.ipynb')}
    assert kept == {f'1/submitted/{NOTEBOOK}': 'version 1'}
    assert not list(course.gradebook.rglob('.new-*'))


def test_no_archive_writes_anywhere_else(course, source, tmp_path):
    secret = tmp_path / 'secret'
    secret.write_text('secret')
    link = zipfile.ZipInfo(f'eve/{NOTEBOOK}')
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(source / 'class.zip', 'w') as box:
        box.writestr(f'../../../submitted/ada/{TOY}/{NOTEBOOK}', 'slip')
        box.writestr(f'/{tmp_path}/ada/{TOY}/{NOTEBOOK}', 'absolute')
        box.writestr(link, str(secret))
        box.writestr(f'../{TOY}.ipynb', 'slip')
        box.writestr(f'bob\x1b[2J_{TOY}.ipynb', 'escape')
        box.writestr(f'zoe/{TOY}/{NOTEBOOK}', 'fine')
    outside = {path for path in tmp_path.rglob('*') if course.gradebook not in path.parents}
    found = rows(course, source / 'class.zip')
    assert sorted(found.values()) == [LEFT] * 5 + [NEW]
    assert {path for path in tmp_path.rglob('*') if course.gradebook not in path.parents} == (
        outside | {course.gradebook}
    )
    assert tree(course.gradebook / 'submitted') == {f'zoe/{TOY}/{NOTEBOOK}': 'fine'}


def test_a_file_that_is_in_the_way_costs_only_its_own_row(course, source):
    write(course.gradebook / 'submitted/ada', 'a file')
    write(source / f'ada_{TOY}.ipynb', '')
    write(source / f'bob_{TOY}.ipynb', '')
    assert sorted(rows(course, source).values()) == [LEFT, NEW]
    assert (course.gradebook / 'submitted/ada').read_text() == 'a file'


def test_a_full_disk_is_said_in_a_sentence(course, source, monkeypatch):
    def full(*_):
        raise OSError(28, 'No space left on device')

    write(source / f'ada_{TOY}.ipynb', '')
    monkeypatch.setattr(module, 'put_whole', full)
    with pytest.raises(CourseError, match='the disk is full: what was collected is kept whole'):
        rows(course, source)


# --- whose it is ---------------------------------------------------------------------------------


def uploaded(source, who, number, content, inside=''):
    write(source / f'{who}_{number}_assignsubmission_file_{inside}/{NOTEBOOK}', content)


def numbers(course):
    return json.loads((course.gradebook / 'numbers.json').read_text())


def test_nobody_s_work_is_replaced_by_what_another_named_after_them(course, source):
    uploaded(source, 'Ada Lovelace', 1815, 'hers')
    rows(course, source)
    uploaded(source, 'Mallory Evil', 666, 'forged', '/Ada Lovelace')
    write(source / f'Mallory Evil_666_assignsubmission_file_/Ada Lovelace_{TOY}.ipynb', 'forged')
    with zipfile.ZipFile(source / 'Mallory Evil_666_assignsubmission_file_/a.zip', 'w') as box:
        box.writestr(f'Lovelace, Ada/{NOTEBOOK}', 'forged')
    assert sorted(rows(course, source).values()) == [KNOWN, LEFT, LEFT, LEFT]
    assert submitted(course, 'Ada Lovelace') == {NOTEBOOK: 'hers'}
    assert [path.name for path in (course.gradebook / 'submitted').iterdir()] == ['Ada Lovelace']


def test_moodle_s_number_is_kept_and_a_namesake_is_left_to_a_person(course, source, tmp_path):
    uploaded(source, 'Ada Lovelace', 1815, 'hers')
    uploaded(source, '王小明', 7, 'his')
    assert set(rows(course, source).values()) == {NEW}
    kept = {
        'Ada Lovelace': {TOY: {'moodle': '1815'}},
        '王小明': {TOY: {'moodle': '7'}},
    }
    assert numbers(course) == kept
    uploaded(tmp_path / 'later', 'Ada Lovelace', 1906, 'another’s')
    (row,) = collect(course, tmp_path / 'later')
    assert row.outcome == LEFT
    assert "the name Ada Lovelace has Moodle's number 1906 here and 1815 elsewhere" in row.reason
    assert submitted(course, 'Ada Lovelace') == {NOTEBOOK: 'hers'}
    (tmp_path / 'later/Ada Lovelace_1906_assignsubmission_file_').rename(
        tmp_path / 'later/Ada Lovelace'
    )
    assert set(rows(course, tmp_path / 'later').values()) == {AGAIN}
    assert numbers(course) == kept


def test_two_downloads_that_disagree_on_a_number_are_both_left(course, source):
    for number, folder in ((1, 'monday'), (2, 'tuesday')):
        uploaded(source / folder, 'Ada Lovelace', number, folder)
    assert set(rows(course, source).values()) == {LEFT}
    assert not (course.gradebook / 'numbers.json').exists()


def test_canvas_numbers_a_student_once(course, source):
    write(source / f'lovelaceada_18151_21012_{TOY}.ipynb', 'one')
    assert set(rows(course, source).values()) == {NEW}
    (source / f'lovelaceada_18151_21012_{TOY}.ipynb').unlink()
    write(source / f'lovelaceada_LATE_18151_21999_{TOY}-1.ipynb', 'two')
    assert set(rows(course, source).values()) == {AGAIN}
    write(source / f'lovelaceada_19061_22000_{TOY}.ipynb', 'another’s')
    assert set(rows(course, source).values()) == {LEFT}
    assert numbers(course) == {'lovelaceada': {TOY: {'canvas': '18151'}}}


@pytest.mark.parametrize('packed', [False, True])
def test_a_class_s_folder_like_a_name_of_canvas_s_is_no_student(packed, course, source):
    folder = source / 'kurs_101_202'
    write(folder / 'ada' / NOTEBOOK, 'hers')
    write(folder / f'bob_{TOY}.ipynb', 'his')
    if packed:
        shutil.make_archive(str(folder), 'zip', source, folder.name)
        folder = folder.with_suffix('.zip')
    assert set(rows(course, folder).values()) == {NEW}
    assert [submitted(course, who)[NOTEBOOK] for who in ('ada', 'bob')] == ['hers', 'his']
    assert not course.folder('submitted', 'kurs', TOY).exists()


def test_blackboard_has_times_and_no_numbers(course, source):
    attempt = f'Lab 1_{{}}_attempt_2026-01-0{{}}-10-00-00_{TOY}.ipynb'
    write(source / attempt.format('ada', 2), 'first')
    write(source / attempt.format('ada', 3), 'second')
    write(source / attempt.format('bob', 2), 'his')
    assert sorted(rows(course, source).values()) == [AGAIN, NEW, NEW]
    assert submitted(course)[NOTEBOOK] == 'second'
    assert submitted(course, 'bob')[NOTEBOOK] == 'his'
    assert not (course.gradebook / 'numbers.json').exists()
    assert sorted(rows(course, source).values()) == [KNOWN, KNOWN, KNOWN]
    write(source / 'later' / attempt.replace('Lab 1', 'Lab 1 again').format('ada', 4), 'third')
    assert set(rows(course, source / 'later').values()) == {AGAIN}


@pytest.mark.parametrize('damage', ['{', '[]', '{"ada": 1}', '{"ada": {"x": {"moodle": 1}}}'])
def test_damaged_numbers_are_said_in_a_sentence(damage, course, source):
    write(course.gradebook / 'numbers.json', damage)
    uploaded(source, 'Ada', 1, '')
    with pytest.raises(CourseError, match='is damaged: put a copy of it back, or remove it'):
        rows(course, source)


def test_a_hostile_time_costs_only_itself(course, source):
    write(source / f'ada/{TOY}/{NOTEBOOK}', 'ada’s')
    write(source / f'ada/{TOY}/timestamp.txt', '1:99999999999999999999999999999.5')
    write(source / f'bob/{TOY}/{NOTEBOOK}', 'bob’s')
    found = {row.path: (row.outcome, row.reason) for row in collect(course, source)}
    assert found == {
        f'ada/{TOY}/{NOTEBOOK}': (NEW, ''),
        f'ada/{TOY}/timestamp.txt': (LEFT, 'it holds no date'),
        f'bob/{TOY}/{NOTEBOOK}': (NEW, ''),
    }


def test_a_folder_of_their_own_is_told_beside_what_was_taken(course, source):
    uploaded(source, 'Ada', 1, '', '/turtles')
    (row,) = collect(course, source)
    assert (row.outcome, row.reason) == (NEW, "from a folder of their own, 'turtles'")


# --- one upload stops nothing --------------------------------------------------------------------


def a_tar_of_digits(path):
    """87 kB on which the tar reader of Python 3.11.7 works for hours."""
    header = tarfile.TarInfo('digits')
    header.type, header.size = tarfile.XHDTYPE, 7_900_000
    with gzip.open(path, 'wb') as packed:
        packed.write(header.tobuf(tarfile.USTAR_FORMAT))
        packed.write(b'1' * header.size)
        packed.write(bytes(-header.size % 512))
        packed.write(tarfile.TarInfo('a.ipynb').tobuf() + bytes(1024))


@pytest.mark.slow
def test_an_archive_that_takes_for_ever_costs_only_itself(course, source, monkeypatch):
    monkeypatch.setattr(uploads, 'LIMITS_OF_ONE', Limits(cpu_sec=2))
    for place in (source, source / f'bob/{TOY}'):
        place.mkdir(parents=True, exist_ok=True)
        a_tar_of_digits(place / 'mallory.tar.gz')
    write(source / f'ada_{TOY}.ipynb', 'ada’s')
    found = {row.path: (row.outcome, row.reason) for row in collect(course, source)}
    assert found.pop(f'ada_{TOY}.ipynb') == (NEW, '')
    assert {path.rpartition('/')[2] for path in found} <= {'mallory.tar.gz', 'a.ipynb'}
    for outcome, reason in found.values():
        assert outcome == LEFT
        assert 'over 2 s of processor time' in reason or 'named after no assignment' in reason


def test_an_archive_that_takes_too_much_memory_costs_only_itself(course, source, monkeypatch):
    limits = Limits(memory_bytes=40_000_000)  # the reader itself does not fit in
    monkeypatch.setattr(uploads, 'LIMITS_OF_ONE', limits)
    with zipfile.ZipFile(source / 'mallory.zip', 'w') as box:
        box.writestr(NOTEBOOK, 'x' * 10_000_000)
    write(source / f'ada_{TOY}.ipynb', 'ada’s')
    assert rows(course, source) == {'mallory.zip': LEFT, f'ada_{TOY}.ipynb': NEW}


def test_a_file_that_can_t_be_read_costs_only_itself(course, source, monkeypatch):
    """It may lie on a damaged disk, or be gone since the folder was listed."""
    for student in ('ada', 'bob', 'zoe'):
        write(source / f'{student}_{TOY}.ipynb', student)
        write(source / f'{student}-{TOY}.ipynb', student)
    lstat, read, open_file, opened = os.lstat, os.read, os.open, {}

    def remembered(path, *arguments, **options):
        descriptor = open_file(path, *arguments, **options)
        opened[descriptor] = str(path)
        return descriptor

    def damaged(descriptor, size):
        if opened.get(descriptor, '').startswith('ada'):
            raise OSError(5, 'Input/output error')
        return read(descriptor, size)

    def gone(path, **options):
        if str(path).startswith('bob_'):
            raise FileNotFoundError(2, 'No such file or directory', str(path))
        return lstat(path, **options)

    monkeypatch.setattr(os, 'open', remembered)
    monkeypatch.setattr(os, 'read', damaged)
    monkeypatch.setattr(os, 'lstat', gone)
    assert rows(course, source) == {
        f'ada_{TOY}.ipynb': LEFT,
        f'ada-{TOY}.ipynb': LEFT,
        f'bob_{TOY}.ipynb': LEFT,
        f'bob-{TOY}.ipynb': NEW,
        f'zoe-{TOY}.ipynb': NEW,
        f'zoe_{TOY}.ipynb': UNUSED,
    }
    (source / f'ada_{TOY}.ipynb').unlink()
    (row,) = (row for row in collect(course, source) if row.path.startswith('ada'))
    assert (row.outcome, row.reason) == (LEFT, 'it can not be read: Input/output error')


def test_thousands_of_broken_files_print_some_lines(course, source, capsys):
    for student, name in (('mallory', '{}.ipynb'), ('eve', 'a_' + 'z' * 200 + '{}.ipynb')):
        with zipfile.ZipFile(source / f'{student}.zip', 'w') as box:
            for number in range(3_000):
                box.writestr(name.format(number), 'x')
        packed = (source / f'{student}.zip').read_bytes()
        (source / f'{student}.zip').write_bytes(packed.replace(b'x' + b'PK\x03', b'yPK\x03'))
    write(source / f'ada_{TOY}.ipynb', 'ada’s')
    for number in range(9):
        write(source / f'homework {number}.zip', '')
    assert main(['collect', str(source)], course=course) == 1
    out = capsys.readouterr().out
    assert len(out.splitlines()) < 40
    assert max(map(len, out.splitlines())) < 400
    assert '… and 2,996 more like it' in out
    assert out.count('homework') == 9
    assert '1 new; 6009 not taken.' in out


# --- the command ---------------------------------------------------------------------------------


def test_the_command_prints_a_row_for_each_and_ends_with_1_where_one_was_not_taken(
    course, source, capsys
):
    write(source / f'小明_{TOY}.ipynb', 'x')
    os.utime(source / f'小明_{TOY}.ipynb', (1_700_000_000, 1_700_000_000))
    assert main(['collect', str(source), '--file-times'], course=course) == 0
    assert capsys.readouterr().out.splitlines() == [
        'student  assignment  handed in (UTC)',
        '小明     00_toy      2023-11-14 22:13:20  new',
        '',
        '1 new; 0 not taken.',
        'Next: ./course grade',
    ]
    write(source / '\x1b[31mred.ipynb', '')
    for number in range(5):
        write(source / f'photos/{number}.png', '')
    assert main(['collect', str(source)], course=course) == 1
    out = capsys.readouterr().out
    assert '\x1b' not in out
    assert '\\x1b[31mred.ipynb  named after no assignment: expected STUDENT_ASSIGNMENT' in out
    assert 'photos/0.png and 4 more  neither a notebook nor Python' in out
    assert out.splitlines()[-2:] == ['1 there already; 1 not taken.', 'Next: ./course grade']


def test_nothing_that_is_there_to_collect_is_said(course, tmp_path, capsys):
    assert main(['collect', str(tmp_path / 'nowhere')], course=course) == 1
    assert 'nowhere is not there: expected a folder' in capsys.readouterr().err
    (tmp_path / 'empty').mkdir()
    assert main(['collect', str(tmp_path / 'empty')], course=course) == 1
    assert capsys.readouterr().out == (
        f'Nothing was taken: there is no file in {tmp_path / "empty"}\n'
    )


def test_the_report_begins_with_a_line_whatever_it_tells(course, tmp_path, capsys):
    (tmp_path / 'litter').mkdir()
    (tmp_path / 'litter' / '.DS_Store').write_text('')
    assert main(['collect', str(tmp_path / 'litter')], course=course) == 1
    assert capsys.readouterr().out.splitlines() == [
        'Not used for grading:',
        'file       reason',
        '.DS_Store  hidden, or left behind by a program',
        '',
        'Nothing was taken; 0 not taken.',
    ]


def test_nbgrader_reads_the_time(course, source):
    exchanged(source, 1, '{}')
    rows(course, source)
    folder = course.folder('submitted', 'ada', TOY)
    assert CourseDirectory().get_existing_timestamp(str(folder)) == datetime(2026, 1, 1, 10)


def test_large_files_of_a_submission_fill_no_memory(course, source):
    """Each hand-in was held whole, and each earlier one beside it."""
    folder = source / f'ada/{TOY}'
    write(folder / NOTEBOOK, 'hers')
    for number in range(4):
        (folder / f'{number}.py').write_bytes(bytes(10_000_000))
    assert NEW in rows(course, source).values()
    write(folder / NOTEBOOK, 'hers again')
    write(folder / 'timestamp.txt', '2026-01-02 03:04:05 UTC')
    tracemalloc.start()
    try:
        assert AGAIN in rows(course, source).values()
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 10_000_000


@pytest.mark.parametrize('place', ['.', '..', 'notebooks', 'notebooks/zh_CN', 'solutions'])
def test_the_lessons_themselves_are_no_submissions(course, place, monkeypatch, capsys):
    source = course.root / place
    source.mkdir(exist_ok=True)
    monkeypatch.chdir(source)
    assert main(['collect', '.'], course=course) == 1
    said = capsys.readouterr().err
    assert f"{source.resolve()} holds the course's own lessons: expected a folder with" in said
    assert not course.folder('submitted', '', '').exists()


def test_the_lessons_are_known_behind_a_link_and_a_folder_beside_them_is_collected(
    course, tmp_path
):
    link = tmp_path / 'link'
    link.symlink_to(course.root)
    behind_link = Course(root=link, gradebook=course.gradebook)
    for place in link, course.root:
        with pytest.raises(CourseError, match="holds the course's own lessons"):
            list(collect(behind_link, place))
    beside = course.root / 'came in'
    write(beside / f'ada_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    assert [row.outcome for row in collect(behind_link, beside)] == [NEW]


def test_other_spellings_of_a_student_are_told(course, source):
    for name in 'Ada Lovelace', 'ADA_lovelace', 'Ada_Lovelace':
        write(course.folder('submitted', name, '99_other') / '99_other.ipynb', '{}')
    write(source / f'ada_lovelace_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    write(source / f'bob_{TOY}.ipynb', nbformat.writes(course.release(TOY)))
    first, second = collect(course, source)
    assert first.student_id == 'ada_lovelace'
    others = 'ADA_lovelace, Ada Lovelace, Ada_Lovelace'
    assert first.reason == f'not the same as {others}: if it is, rename one'
    assert second.reason == ''
