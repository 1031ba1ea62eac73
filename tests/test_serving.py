"""One process grades all submissions as they come in, and releases their feedback."""

import os
import time
from concurrent.futures import Future
from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import TOY, answered, with_own_database
from nbgrader.auth import Authenticator
from nbgrader.coursedir import CourseDirectory
from nbgrader.exchange.default import ExchangeFetchFeedback, ExchangeSubmit
from quick_serve import (
    RIGHT,
    WRONG,
    exchange_in,
    grade_here,
    hand_in,
    page_of,
    serve_here,
    without_rooms,
)
from traitlets.config import Config

from grader.__main__ import main
from grader.common.dates import date_of
from grader.common.errors import CourseError
from grader.notebook.restore import KEY
from grader.serving import intake, steps
from grader.serving.inbound import new_entries
from grader.serving.queue import FAILED, GRADED, REFUSED, REPLACED, WAITING, Arrival
from grader.serving.queue_file import open_queue, open_queue_to_read
from grader.serving.serve import serving_lock
from grader.serving.state import ServingState
from grader.serving.steps import start_gradings
from grader.storage.records import graded_notebook, records


@pytest.fixture
def course(released, tmp_path):
    return with_own_database(released, tmp_path)


@pytest.fixture
def inbound(tmp_path):
    return exchange_in(tmp_path)


def states(course):
    with open_queue_to_read(course.gradebook) as queue:
        every = queue.find(WAITING, GRADED, REPLACED, REFUSED, FAILED)
    return [(each.student_id, each.state) for each in every]


def test_a_submission_is_graded_and_its_page_is_where_nbgrader_looks_for_it(course, inbound):
    hand_in(course, inbound, 'ada', RIGHT, secret='aa')
    hand_in(course, inbound, 'bob', WRONG, secret='bb')
    said = serve_here(course, inbound)
    scores = {each.student_id: each.score for each in records(course) if 'check' in each.grade_id}
    assert scores == {'ada': 1.0, 'bob': 0.0}
    page = page_of(inbound, 'bb')
    assert 'Expected 2, saw 3' in page.read_text()
    assert 'Expected 2, saw 3' not in page_of(inbound, 'aa').read_text()
    assert (
        page.read_bytes() == (course.folder('feedback', 'bob', TOY) / f'{TOY}.html').read_bytes()
    )
    assert page.stat().st_mode & 0o777 == 0o644
    assert page_of(inbound, 'aa').exists()
    assert [line.partition(':')[0] for line in said] == ['taken in'] * 2 + ['graded'] * 2
    assert not list((course.gradebook / intake.FOLDER).iterdir())


def test_a_served_score_is_reused_by_the_command_grade(course, inbound):
    hand_in(course, inbound, 'ada', RIGHT)
    serve_here(course, inbound)
    (row,) = grade_here(course)
    assert row.reused


def test_a_graded_submission_is_not_graded_again_and_a_later_one_replaces_it(course, inbound):
    hand_in(course, inbound, 'ada', WRONG, secret='aa')
    serve_here(course, inbound)
    assert serve_here(course, inbound) == []
    hand_in(course, inbound, 'ada', RIGHT, number=2, secret='bb')
    serve_here(course, inbound)
    assert states(course) == [('ada', GRADED)] * 2
    assert 'submitted_before' in str(next(course.gradebook.glob('submitted_before/ada/*/1')))
    assert page_of(inbound, 'aa').read_text() != page_of(inbound, 'bb').read_text()


def test_the_same_answer_submitted_again_has_a_page_under_its_own_secret(course, inbound):
    hand_in(course, inbound, 'ada', RIGHT, secret='aa')
    serve_here(course, inbound)
    hand_in(course, inbound, 'ada', RIGHT, number=2, secret='bb')
    serve_here(course, inbound)
    assert page_of(inbound, 'bb').read_bytes() == page_of(inbound, 'aa').read_bytes()


def test_the_newest_submission_is_graded_and_earlier_ones_are_kept(course, inbound):
    for number, answer in enumerate((WRONG, '# 2', RIGHT), start=1):
        folder = hand_in(course, inbound, 'ada', answer, number=number)
        time.sleep(0.02)  # Linux's clock tells them apart
        assert folder.exists()
    serve_here(course, inbound)
    assert sorted(states(course)) == [('ada', GRADED), ('ada', REPLACED), ('ada', REPLACED)]
    kept = sorted(course.gradebook.glob(f'submitted_before/ada/{TOY}/*/submitted/{TOY}.ipynb'))
    assert len(kept) == 2
    there = (course.folder('submitted', 'ada', TOY) / f'{TOY}.ipynb').read_text()
    assert 'return 2 * x' in there


def test_a_submission_time_claimed_by_the_student_is_not_used(course, inbound):
    """The folder's name and its timestamp.txt are the student's to write."""
    began = datetime.now(UTC) - timedelta(seconds=1)  # Linux's clock of files is a little behind
    hand_in(course, inbound, 'ada', RIGHT)
    ended = datetime.now(UTC)
    serve_here(course, inbound)
    stamp = date_of(course.folder('submitted', 'ada', TOY) / 'timestamp.txt')
    assert began <= stamp <= ended


def test_a_submission_over_the_limit_is_kept_and_shown_in_the_status(course, inbound, capsys):
    (course.gradebook / 'deadlines.toml').write_text('[resubmissions]\nin_total = 1\n')
    hand_in(course, inbound, 'ada', WRONG)
    serve_here(course, inbound)
    hand_in(course, inbound, 'ada', RIGHT, number=2, secret='bb')
    serve_here(course, inbound)
    assert states(course) == [('ada', GRADED), ('ada', WAITING)]
    assert not page_of(inbound, 'bb').exists()
    assert 'x + 1' in (course.folder('submitted', 'ada', TOY) / f'{TOY}.ipynb').read_text()
    assert main(['serve', '--status'], course=course) == 0
    assert '1 were graded, and the course grades at most 1: it is kept' in capsys.readouterr().out
    (course.gradebook / 'deadlines.toml').write_text('[resubmissions]\nin_total = 2\n')
    serve_here(course, inbound)
    assert states(course) == [('ada', GRADED), ('ada', GRADED)]


def test_a_submission_without_a_known_student_is_listed_for_a_person(course, inbound, capsys):
    hand_in(course, inbound, 'ada', RIGHT)
    (inbound / 'whose.ipynb').write_text('{}')
    os.utime(inbound / 'whose.ipynb')
    time.sleep(1.1)  # only its age shows that it is complete
    said = serve_here(course, inbound)
    assert any(line.startswith('not taken, look at it: whose.ipynb: ') for line in said)
    assert sorted(state for _, state in states(course)) == [GRADED, REFUSED]
    main(['serve', '--status'], course=course)
    out = capsys.readouterr().out
    assert 'does not run' in out
    assert 'a person should look' in out
    page = (course.gradebook / 'serve_status.html').read_text()
    assert 'whose.ipynb' in page
    assert '<script' not in page


def test_serve_without_a_folder_reports_which_folder_to_name(course, inbound, capsys):
    assert main(['serve'], course=course) == 1
    said = capsys.readouterr().err
    assert said.startswith('course: name the folder into which submissions are put, ')
    assert ': ./course serve FOLDER. ' in said
    assert said.endswith('./course serve --status\n')
    assert main(['serve', str(inbound / 'nowhere')], course=course) == 1
    assert f'{inbound / "nowhere"} is no folder: expected the one' in capsys.readouterr().err
    assert main(['serve', str(course.root / 'notebooks')], course=course) == 1
    assert "notebooks holds the course's own lessons: expected a" in capsys.readouterr().err


def test_a_folder_filled_by_another_platform_is_served_with_its_changes(course, tmp_path):
    folder = tmp_path / 'uploads'
    (folder / 'bob' / TOY).mkdir(parents=True)
    (folder / 'bob' / TOY / f'{TOY}.ipynb').write_text(nbformat.writes(answered(course, RIGHT)))
    (folder / f'ada_{TOY}.ipynb').write_text(nbformat.writes(answered(course, WRONG)))
    time.sleep(1.1)
    serve_here(course, folder)
    assert sorted(states(course)) == [('ada', GRADED), ('bob', GRADED)]
    (folder / f'ada_{TOY}.ipynb').write_text(nbformat.writes(answered(course, RIGHT)))
    time.sleep(1.1)
    serve_here(course, folder)
    assert [state for _, state in states(course)] == [GRADED] * 3


def test_an_incomplete_submission_waits_until_it_is_complete(course, inbound):
    folder = hand_in(course, inbound, 'ada', RIGHT)
    folder.chmod(0o755)  # as it is before nbgrader's last step
    assert list(new_entries(inbound, {})) == []
    folder.chmod(0o777)
    assert [each.name for each in new_entries(inbound, {})] == [folder.name]


def test_only_one_process_may_serve_a_gradebook(course, inbound):
    with serving_lock(course), pytest.raises(CourseError, match='another process serves'):
        serve_here(course, inbound)


@pytest.mark.slow
def test_seeds_follow_the_answer_only_if_hidden_inputs_are_chosen_anew(course, inbound):
    """The final grade replays: the seed follows from what was handed in."""

    def seed():
        return graded_notebook(course, 'ada', TOY).metadata[KEY].seed

    seeds = {}
    for policy in ('kept', 'anew'):
        text = f'[resubmissions]\nhidden_inputs = "{policy}"\n'
        (course.gradebook / 'deadlines.toml').write_text(text)
        for number, answer in enumerate((WRONG, RIGHT, WRONG), start=1):
            hand_in(course, inbound, 'ada', answer, number=number + 3 * (policy == 'anew'))
            serve_here(course, inbound)
            seeds[policy, number] = seed()
    assert seeds['kept', 1] == seeds['kept', 2] == course.seed(TOY, 'ada')
    assert seeds['anew', 1] == seeds['anew', 3] != seeds['anew', 2]
    assert course.seed(TOY, 'ada') not in (seeds['anew', 1], seeds['anew', 2])
    (row,) = grade_here(course)
    assert row.reused


def test_only_one_submission_of_a_student_is_graded_at_a_time(course, tmp_path, monkeypatch):
    begun = []

    def begin(serving, arrival, earlier):
        serving.queue.update(arrival)
        serving.running[Future()] = arrival
        begun.append(arrival.submission_key)

    monkeypatch.setattr(steps, 'start_grading', begin)
    handed_in = [('ada', 'a'), ('ada', 'b'), ('bob', 'a')]
    arrivals = [
        Arrival(0, who, at, WAITING, who, lesson) for at, (who, lesson) in enumerate(handed_in)
    ]
    grading = SimpleNamespace(backend=SimpleNamespace(capacity=4))
    with open_queue(course.gradebook, tmp_path) as queue:
        queue.add('all of them', '', arrivals)
        serving = ServingState(course, queue, grading, tmp_path, None, print, exporter=None)
        assert start_gradings(serving)
        assert begun == [('ada', 'b'), ('bob', 'a')]
        assert not start_gradings(serving)  # while these are graded
        serving.running.clear()
        assert start_gradings(serving)
    assert begun[2:] == [('ada', 'a')]


def test_a_grade_with_newly_chosen_hidden_inputs_is_replayed_exactly(course, inbound, capsys):
    (course.gradebook / 'deadlines.toml').write_text('[resubmissions]\nhidden_inputs = "anew"\n')
    hand_in(course, inbound, 'ada', WRONG)
    serve_here(course, inbound)
    seed = graded_notebook(course, 'ada', TOY).metadata[KEY].seed
    assert seed != course.seed(TOY, 'ada')
    with without_rooms():
        main(['grade', '--student', 'ada', '--seed', 'recorded'], course=course)
        said = capsys.readouterr().out
        assert f'seed {seed}\n' in said
        assert 'The same as in the gradebook.' in said
        assert main(['grade', '--force'], course=course) == 0
    assert graded_notebook(course, 'ada', TOY).metadata[KEY].seed == seed


def test_a_student_submits_and_fetches_feedback_with_nbgrader_itself(course, tmp_path):
    """nbgrader's own code makes the folder of the submission, and finds our page."""
    exchange, student = tmp_path / 'exchange', tmp_path / 'student'
    for folder in ('inbound', 'outbound', 'feedback'):
        (exchange / 'robots' / folder).mkdir(parents=True)
    for folder in (exchange / 'robots' / 'outbound' / TOY, student / TOY):
        folder.mkdir(parents=True)
        (folder / f'{TOY}.ipynb').write_text(nbformat.writes(answered(course, WRONG)))
    config = Config()
    config.Exchange.root = str(exchange)
    config.Exchange.cache = str(tmp_path / 'cache')
    config.Exchange.assignment_dir = str(student)
    config.CourseDirectory.course_id = 'robots'
    config.CourseDirectory.assignment_id = TOY

    def nbgrader(action):
        options = {'coursedir': CourseDirectory(config=config)}
        action(config=config, authenticator=Authenticator(config=config), **options).start()

    exchange.chmod(0o777)
    nbgrader(ExchangeSubmit)
    assert len(list(new_entries(exchange / 'robots' / 'inbound', {}))) == 1  # complete at once
    serve_here(course, exchange / 'robots' / 'inbound')
    nbgrader(ExchangeFetchFeedback)
    (fetched,) = student.glob(f'{TOY}/feedback/*/{TOY}.html')
    assert 'Expected 2, saw 3' in fetched.read_text()
