import errno
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from course_maker import TOY, answered, make_course, released_course, submit

from grader.__main__ import main
from grader.common.errors import CourseError
from grader.course import Course
from grader.kernels import isolation
from grader.storage import failures
from grader.storage.backups import back_up
from grader.storage.database import make_database
from grader.storage.lock import gradebook_lock


def test_help_lists_every_verb(capsys):
    with pytest.raises(SystemExit) as end:
        main(['--help'])
    assert end.value.code == 0
    text = capsys.readouterr().out
    assert all(verb in text for verb in ('release', 'collect', 'grade', 'scores', 'demo'))


@pytest.mark.parametrize(
    'arguments',
    [
        [],
        ['nothing'],
        ['grade', '--seed', 'no hex'],
        ['grade', '--workers', '0'],
        ['grade', '--workers', '-1'],
        ['grade', '--workers', 'two'],
        ['grade', '--workers', '2', '--dask', 'tcp://127.0.0.1:8786'],
        ['release', 'a', 'b'],
    ],
)
def test_wrong_arguments_end_with_status_2(arguments):
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2


VERBS_WITH_FEW_ARGUMENTS = {
    **{verb: [verb, 'b'] for verb in ('translate', 'feedback', 'demo', 'doctor')},
    **{verb: [verb, 'a', 'b'] for verb in ('release', 'solutions', 'grade', 'bundle', 'collect')},
}


@pytest.mark.parametrize('verb', VERBS_WITH_FEW_ARGUMENTS)
def test_a_surplus_argument_is_reported_with_the_usage_of_its_verb(verb, capsys):
    with pytest.raises(SystemExit) as end:
        main(VERBS_WITH_FEW_ARGUMENTS[verb])
    said = capsys.readouterr().err
    assert said.startswith(f'usage: ./course {verb} [-h]')
    assert said.endswith(f'./course {verb}: error: unrecognized arguments: b\n')
    assert end.value.code == 2


@pytest.mark.parametrize('verb', ['grade', 'scores', 'feedback', 'due', 'collect', 'serve'])
@pytest.mark.parametrize('is_link', [False, True], ids=['a file', 'a link'])
def test_a_file_or_broken_link_in_place_of_the_gradebook_is_named(tmp_path, capsys, verb, is_link):
    course = make_course(tmp_path)
    if is_link:
        course.gradebook.symlink_to(tmp_path / 'nowhere')
    else:
        course.gradebook.write_text('kept')
    where = [str(tmp_path)] if verb in ('collect', 'serve') else []
    assert main([verb, *where], course=course) == 1
    said = capsys.readouterr()
    what = 'a link that leads nowhere' if is_link else 'a file'
    assert said.err.startswith(f'course: {course.gradebook} is {what}; a folder was expected: ')
    assert said.out == ''
    assert is_link or course.gradebook.read_text() == 'kept'


def graded_course(folder):
    """Return a course with a submission and its scores, and their table."""
    course = make_course(folder)
    assert main(['release'], course=course) == 0
    submit(course, 'ada', b'')
    assert main(['grade'], course=course) == 0
    assert main(['scores'], course=course) == 0
    return course, (course.gradebook / 'scores.csv').read_bytes()


def test_an_emptied_database_is_reported_as_damaged_after_grading(tmp_path, capsys):
    course, table = graded_course(tmp_path)
    backup = back_up(course)
    course.database.write_bytes(b'')
    capsys.readouterr()
    for verb in ('scores', 'feedback', 'grade'):
        assert main([verb], course=course) == 1
        said = capsys.readouterr().err
        assert f'course: {course.database} is damaged (the file is empty). ' in said
        assert f"cp '{backup}' '{course.database}'" in said
    assert back_up(Course.at(tmp_path / 'other')) is None
    assert (course.gradebook / 'scores.csv').read_bytes() == table
    assert course.database.read_bytes() == b''
    for each in (course.gradebook / 'backups').iterdir():
        each.unlink()
    assert main(['scores'], course=course) == 1
    said = capsys.readouterr().err
    assert 'There is no backup in' in said
    assert 'move the file away and run ./course grade' in said
    course.database.rename(tmp_path / 'away')
    assert main(['grade'], course=course) == 0
    assert main(['scores'], course=course) == 0
    assert (course.gradebook / 'scores.csv').read_bytes() == table


def test_a_database_that_is_gone_is_not_replaced_by_one_without_scores(tmp_path, capsys):
    course, table = graded_course(tmp_path)
    backup = back_up(course)
    course.database.unlink()
    capsys.readouterr()
    for verb in ('scores', 'feedback', 'grade'):
        assert main([verb], course=course) == 1
        said = capsys.readouterr().err
        assert f"{course.database} is gone. Put a backup in its place with cp '{backup}'" in said
    assert not course.database.exists()
    assert (course.gradebook / 'scores.csv').read_bytes() == table
    shutil.copy(backup, course.database)
    assert main(['scores'], course=course) == 0
    assert (course.gradebook / 'scores.csv').read_bytes() == table
    shutil.rmtree(course.gradebook / 'backups')
    course.database.unlink()
    for verb in ('scores', 'feedback'):
        capsys.readouterr()
        assert main([verb], course=course) == 1
        assert 'has no copy of it: put yours in its place' in capsys.readouterr().err
    assert (course.gradebook / 'scores.csv').read_bytes() == table
    assert main(['grade'], course=course) == 0


def test_an_empty_database_before_anything_is_graded_is_made_anew(tmp_path, capsys):
    course = make_course(tmp_path)
    course.gradebook.mkdir()
    course.database.write_bytes(b'')
    assert main(['scores'], course=course) == 0
    assert capsys.readouterr().err == 'Nothing is graded yet. Next: ./course grade\n'
    assert course.database.stat().st_size


@pytest.mark.parametrize('kept', ['no hex', '', '\N{SNOWMAN}'])
def test_a_damaged_secret_is_named(tmp_path, capsys, kept):
    course = make_course(tmp_path)
    assert main(['release'], course=course) == 0
    submit(course, 'ada', b'')
    secret = course.gradebook / 'course_secret'
    secret.write_text(kept, encoding='utf-8')
    capsys.readouterr()
    assert main(['grade'], course=course) == 1
    said = capsys.readouterr().err
    assert said.startswith(f'course: {secret} is damaged: expected hexadecimal digits. Restore it')
    assert said.count('\n') == 1
    assert secret.read_text(encoding='utf-8') == kept


def test_the_error_about_a_missing_sandbox_announces_a_note_on_feedback_pages(monkeypatch):
    monkeypatch.setattr(isolation, 'missing_protection', lambda: 'there is none')
    with pytest.raises(CourseError, match=r'--trust-students\. Each feedback page will say so\.'):
        isolation.require_isolation()


def test_a_course_error_is_one_line_without_escapes_and_has_status_1(tmp_path, capsys):
    (tmp_path / 'solutions').mkdir()
    assert main(['grade', '\x1b[31mred'], course=Course.at(tmp_path)) == 1
    err = capsys.readouterr().err
    assert err.startswith('course: there is no assignment ')
    assert '\x1b' not in err
    assert err.count('\n') == 1


def test_an_invalid_seed_is_refused_with_the_expected_form(capsys):
    with pytest.raises(SystemExit):
        main(['grade', '--seed', 'no hex'])
    said = capsys.readouterr().err
    assert said.endswith("'no hex' is neither a hexadecimal number nor recorded\n")


def test_scores_of_an_unknown_assignment_name_the_existing_ones(tmp_path, capsys):
    assert main(['scores', '3', '--format', 'canvas'], course=make_course(tmp_path)) == 1
    said = capsys.readouterr().err
    assert said.startswith("course: there is no assignment '3'")
    assert said.endswith(f'there are: {TOY}\n')


def test_a_stopped_run_says_how_to_go_on(tmp_path, capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr('grader.cli.begin_grade.find_submissions', interrupted)
    assert main(['grade'], course=Course.at(tmp_path)) == 130
    assert 'run it again to go on' in capsys.readouterr().err


def test_a_run_that_is_stopped_while_a_class_is_made_says_how_to_go_on(
    tmp_path, capsys, monkeypatch
):
    class Named:
        def __set_name__(self, *_):
            raise KeyboardInterrupt  # Ctrl-C while a module with a dataclass is imported

    def importing(*_, **__):
        type('Made', (), {'it': Named()})

    monkeypatch.setattr('grader.cli.begin_grade.find_submissions', importing)
    assert main(['grade'], course=Course.at(tmp_path)) == 130
    assert 'run it again to go on' in capsys.readouterr().err


def test_all_verbs_work_one_after_another(tmp_path, capsys):
    course = make_course(tmp_path)
    assert main(['release', TOY], course=course) == 0
    released = f'notebooks/{TOY}/{TOY}.ipynb\nnotebooks/index.ipynb\n'
    moved = f'solutions/{TOY}/{TOY}.ipynb holds no pictures any more: they are in notebooks/ now\n'
    assert capsys.readouterr().out == f'{moved}{released}2 files changed.\n'
    for verb in ('scores', 'feedback'):
        assert main([verb], course=course) == 0
        said = capsys.readouterr()
        assert said.err == 'Nothing is graded yet. Next: ./course grade\n'
        assert said.out.startswith(str(course.gradebook)) == (verb == 'scores')
    assert main(['grade'], course=course) == 1
    assert 'where ./course collect FOLDER puts' in capsys.readouterr().err
    submit(course, 'ada', b'')
    (course.folder('submitted', 'eve', '99_other')).mkdir(parents=True)
    assert main(['grade'], course=course) == 1  # eve's could not be placed
    counts = '{} graded, {} unchanged, {} could not be graded (–); 0 wait for a person (…).'
    assert counts.format(1, 0, 1) in capsys.readouterr().out
    assert main(['grade', '--student', 'ada'], course=course) == 0
    said = capsys.readouterr().out
    assert counts.format(0, 1, 0) in said
    assert 'Next: ./course feedback, ' in said
    assert main(['feedback'], course=course) == 0
    assert 'feedback/ada/' in capsys.readouterr().out
    assert main(['scores'], course=course) == 0
    assert capsys.readouterr().out == f'{course.gradebook / "scores.csv"}\n'
    assert 'ada,00_toy,double-check,0.0,1.0' in (course.gradebook / 'scores.csv').read_text()
    assert main(['release'], course=course) == 0
    assert 'Nothing has changed' in capsys.readouterr().out


@pytest.mark.starts
def test_grading_by_hand_is_suggested_before_feedback_and_scores(tmp_path, capsys):
    course = released_course(tmp_path)
    right = 'def double(x):\n    return 2 * x'
    submit(course, 'ada', answered(course, right, explained='Because.'))
    assert main(['grade'], course=course) == 0
    first, _, then = capsys.readouterr().out.partition('Next: ')[2].partition('), ')
    assert first == 'points by hand (.venv/bin/jupyter lab, menu Nbgrader, Formgrader'
    assert then == './course feedback, ./course scores\n'


def test_a_database_in_use_is_waited_for_with_a_message(tmp_path, capsys, monkeypatch):
    course = make_course(tmp_path)
    make_database(course)
    monkeypatch.setattr(failures, 'TIMEOUT_SEC', 0.2)
    with closing(sqlite3.connect(course.database, isolation_level=None)) as other:
        other.execute('BEGIN EXCLUSIVE')
        for verb in ('scores', 'feedback'):
            assert main([verb], course=course) == 1
            said = capsys.readouterr()
            assert said.out == f'waiting: another program is using {course.database}\n'
            assert 'run the same command again' in said.err


def test_a_pipe_receives_each_line_as_soon_as_it_is_printed(tmp_path):
    make_course(tmp_path)
    code = """
import sys
from pathlib import Path
from grader.__main__ import main
from grader.course import Course
main(['feedback'], course=Course.at(Path(sys.argv[1])))
sys.stdin.read()
"""
    command = [sys.executable, '-c', code, str(tmp_path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline().startswith('0 pages in ')
        process.communicate('')


def test_a_closed_output_pipe_ends_a_command_with_a_message(tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    course = make_course(tmp_path)
    program = 'import sys; from pathlib import Path; from grader.__main__ import main; '
    program += 'from grader.course import Course; '
    program += f'sys.exit(main(["due"], course=Course(Path({str(course.root)!r}))))'
    ran = subprocess.run([sys.executable, '-c', program], stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    assert ran.stderr.decode() == (
        'course: stopped, because nothing reads the output any more. What was finished is kept; '
        'run it again to go on.\n'
    )
    assert ran.returncode == 141


def test_a_second_writer_waits_for_the_first_and_says_so(tmp_path):
    hold = (
        'import sys, time\n'
        'from pathlib import Path\n'
        'from grader.storage.lock import gradebook_lock\n'
        'with gradebook_lock(Path(sys.argv[1])):\n'
        '    print("mine", flush=True)\n'
        '    sys.stdin.read()\n'
    )
    command = [sys.executable, '-c', hold, str(tmp_path)]
    pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE, 'text': True}
    with subprocess.Popen(command, **pipes) as first:
        assert first.stdout.readline() == 'mine\n'
        with subprocess.Popen(command, **pipes) as second:
            try:
                assert second.stdout.readline() == (
                    f'waiting: process {first.pid} is grading into {tmp_path}\n'
                )
            finally:
                first.send_signal(signal.SIGKILL)  # a lock ends with its holder
            assert second.stdout.readline() == 'mine\n'
            second.communicate('')


def test_a_lock_is_released_if_its_holder_cannot_be_written_down(tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, 'No space left on device')

    with monkeypatch.context() as patch:
        patch.setattr(Path, 'write_text', full)
        with pytest.raises(OSError, match='No space'), gradebook_lock(tmp_path):
            pytest.fail('the lock was taken')
    with gradebook_lock(tmp_path, say=pytest.fail):
        assert (tmp_path / '.lock').read_text() == str(os.getpid())


def test_a_lock_that_is_taken_again_is_free_only_at_the_end_of_the_outermost_block(tmp_path):
    def is_free():
        return not subprocess.run(
            ['flock', '--nonblock', str(tmp_path / '.lock'), 'true'], check=False, env=os.environ
        ).returncode

    with gradebook_lock(tmp_path):
        with gradebook_lock(tmp_path):
            assert not is_free()
        assert not is_free()
    assert is_free()


def test_the_sample_class_has_16_to_20_notebooks_named_after_outcomes():
    from grader.cli.demo import SAMPLES

    names = [path.stem.split('-', 2) for path in SAMPLES.glob('*.ipynb')]
    assert 16 <= len(names) <= 20
    assert {outcome for _, outcome, _ in names} <= {'pass', 'fail', 'mixed', 'zero'}


def test_a_sample_is_submitted_with_the_solutions_package_and_its_own_files(tmp_path):
    from grader.cli.demo import SAMPLES, hand_in

    course = Course(gradebook=tmp_path / 'gradebook')
    ours = course.source_path('12_package').with_name('arm_player')
    (sample,) = SAMPLES.glob('12_package-pass-*.ipynb')
    other = tmp_path / '12_package-fail-other.ipynb'
    shutil.copyfile(sample, other)
    (tmp_path / other.stem / 'arm_player').mkdir(parents=True)
    (tmp_path / other.stem / 'arm_player/setup.py').write_text('1 / 0')
    for path, setup in ((sample, (ours / 'setup.py').read_text()), (other, '1 / 0')):
        hand_in(course, path, '12_package')
        place = course.folder('submitted', path.stem, '12_package')
        assert (place / '12_package.ipynb').read_bytes() == sample.read_bytes()
        assert (place / 'arm_player/setup.py').read_text() == setup
        came = {file.relative_to(place / 'arm_player') for file in place.rglob('*.py')}
        assert came == {file.relative_to(ours) for file in ours.rglob('*.py')}


def test_the_seed_of_an_unknown_assignment_is_refused(tmp_path):
    with pytest.raises(CourseError, match='there are: none'):
        Course.at(tmp_path).seed('99', 'ada')
