"""Whatever ends `./course serve`, or runs beside it, nothing is lost or graded differently."""

import random
import signal
import sqlite3
import subprocess
import time
from contextlib import closing
from pathlib import Path

import pytest
import quick_serve
from course_maker import TOY, released_course, with_own_database
from quick_serve import RIGHT, WRONG, exchange_in, grade_here, hand_in, page_of, serve_here

from grader.__main__ import main
from grader.common.errors import CourseError
from grader.grading import CHANGED
from grader.serving.queue import FAILED, GRADED, REFUSED, REPLACED, WAITING
from grader.serving.queue_file import open_queue_to_read
from grader.storage.deadlines import FILE
from grader.storage.records import records


@pytest.fixture
def inbound(tmp_path):
    return exchange_in(tmp_path)


def killed_rounds(course, inbound, rounds, chance):
    """Serve under load, and SIGKILL it at random moments; then serve to the end."""
    command = quick_serve.command(course, inbound)
    students, number = ['ada', 'bob', 'zoe'], 0
    latest = {}
    for _ in range(rounds):
        for student in students:
            number += 1
            secret = f'{number:04}'
            answer = f'# {chance.uniform(0, 0.3):.2f} s\n' + chance.choice([RIGHT, WRONG])
            latest[student] = (answer, secret)
            hand_in(course, inbound, student, answer, number=number, secret=secret)
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        for line in process.stdout:  # killed once it is at work, not while it starts
            if 'taken in' in line:
                break
        time.sleep(chance.uniform(0, 1.5))
        process.send_signal(signal.SIGKILL)
        process.wait()
        process.stdout.close()
        for page in (inbound.parent / 'feedback').glob('*.html'):
            assert page.read_text().rstrip().endswith('</html>'), 'half a page'
    end = subprocess.run([*command, '--once'], capture_output=True, text=True, timeout=300)
    assert end.returncode == 0, end.stderr
    return number, latest


def same_as_undisturbed(course, inbound, handed_in, latest):
    """Assert that nothing is lost, and that each score and page is as in an undisturbed run."""
    with open_queue_to_read(course.gradebook) as queue:
        arrivals = queue.find(GRADED, REPLACED, WAITING, REFUSED, FAILED, 'grading')
    assert len(arrivals) == len({each.entry for each in arrivals}) == handed_in
    assert {each.state for each in arrivals} <= {GRADED, REPLACED}
    with closing(sqlite3.connect(course.database)) as database:
        assert database.execute('PRAGMA integrity_check').fetchone() == ('ok',)
    kept = {
        path.read_bytes()
        for pattern in ('submitted/*/*/*.ipynb', 'submitted_before/*/*/*/submitted/*.ipynb')
        for path in course.gradebook.glob(pattern)
    }
    for path in inbound.glob('*/*.ipynb'):
        assert path.read_bytes() in kept, f'{path} is lost'
    scores = {r.student_id: r.score for r in records(course) if r.grade_id == 'double-check'}
    for student, (answer, secret) in latest.items():
        assert scores[student] == float('2 * x' in answer)
        assert page_of(inbound, secret).exists()
    for each in arrivals:
        secret = (inbound / each.entry / 'submission_secret.txt').read_text()
        answer = (inbound / each.entry / f'{TOY}.ipynb').read_text()
        if each.state == GRADED:
            assert each.score == 3.0 * ('2 * x' in answer)
            assert page_of(inbound, secret).read_text().rstrip().endswith('</html>')


@pytest.mark.slow
@pytest.mark.parametrize('rounds', [2, 20])
def test_serve_killed_at_random_moments_loses_no_submission_page_or_score(
    rounds, tmp_path, inbound
):
    course = released_course(tmp_path / 'course')
    handed_in, latest = killed_rounds(course, inbound, rounds, random.Random(rounds))
    same_as_undisturbed(course, inbound, handed_in, latest)


@pytest.mark.slow
def test_grade_may_run_beside_serve(tmp_path, inbound):
    course = released_course(tmp_path / 'course')
    process = subprocess.Popen(
        quick_serve.command(course, inbound), stdout=subprocess.PIPE, text=True
    )
    latest, others = {}, []
    try:
        for number in range(1, 4):
            for student in ('ada', 'bob'):
                answer = f'# {number / 20:.2f} s\n{RIGHT if number % 2 else WRONG}'
                secret = f'{student}{number}'
                hand_in(course, inbound, student, answer, number=number, secret=secret)
                latest[student] = answer, secret
        deadline = time.monotonic() + 300
        while not any(course.gradebook.glob('submitted/*/*/*.ipynb')):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        while not all(page_of(inbound, secret).exists() for _, secret in latest.values()):
            assert time.monotonic() < deadline
            assert process.poll() is None
            others += grade_here(course)
    finally:
        process.terminate()
        process.wait(timeout=60)
        process.stdout.close()
    serve_here(course, inbound)  # some entries may not have been looked at yet
    assert others
    refused = {row.reason for row in others if not row.stored}
    assert refused <= {f'not graded, {CHANGED}'}
    same_as_undisturbed(course, inbound, 6, latest)


def test_serving_pauses_while_the_due_dates_can_not_be_read(released, tmp_path, inbound, capsys):
    course = with_own_database(released, tmp_path)
    hand_in(course, inbound, 'ada', RIGHT)
    path, said = course.gradebook / FILE, []

    def say(line):
        said.append(line.partition(':')[0])
        if said[1:] == ['graded']:
            path.write_text('foo = ')
            hand_in(course, inbound, 'bob', RIGHT)
        if said[-1] == 'paused':
            assert main(['serve', '--status'], course=course) == 0
            path.write_text('')
        if said.count('graded') == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        serve_here(course, inbound, once=False, say=say)
    assert sorted(said[2:4]) == ['paused', 'taken in']
    assert said[4:] == ['grading goes on', 'graded']
    status = capsys.readouterr().out
    assert 'Paused: nothing is graded until this is corrected' in status
    assert f'{path}: Invalid value' in status
    path.write_text('foo = ')
    with pytest.raises(CourseError, match='Invalid value'):
        serve_here(course, inbound)


@pytest.mark.slow
def test_sigterm_ends_serve_and_its_submission_stays_in_the_queue(tmp_path, inbound):
    course = released_course(tmp_path / 'course')
    hand_in(course, inbound, 'ada', f'# 600 s\n{RIGHT}')
    command = quick_serve.command(course, inbound)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert 'taken in' in process.stdout.readline()
    process.terminate()
    assert process.wait(timeout=60) == 128 + signal.SIGTERM
    process.stdout.close()
    with open_queue_to_read(course.gradebook) as queue:
        assert len(queue.find(WAITING, 'grading')) == 1
    assert Path(course.gradebook / 'arrived').is_dir()
