"""The order in which waiting submissions are graded."""

import pytest

from grader.common.errors import CourseError
from grader.serving.queue import WAITING, Arrival
from grader.serving.turns import next_turn, reason_to_wait, replaced_by
from grader.storage.deadlines import read_deadlines
from grader.storage.resubmissions import ResubmissionRules

NO_RULES = ResubmissionRules()
NOW = 10_000.0


def arrival(number, student, assignment='a', arrived=None):
    return Arrival(number, f'{number}', arrived or float(number), WAITING, student, assignment)


def turn(waiting, *, busy=(), starts=None, rules=NO_RULES):
    found = next_turn(waiting, busy, starts or {}, rules, NOW)
    return found and found.number


def test_the_newest_submission_of_a_student_comes_first_and_replaces_earlier_ones():
    waiting = [arrival(1, 'ada'), arrival(2, 'ada', 'b'), arrival(3, 'ada')]
    assert turn(waiting) == 3
    assert [each.number for each in replaced_by(waiting[2], waiting)] == [1]


def test_one_submission_of_a_student_is_graded_at_a_time():
    waiting = [arrival(1, 'ada'), arrival(2, 'bob')]
    assert turn(waiting, busy={'ada'}) == 2
    assert turn(waiting, busy={'ada', 'bob'}) is None


def test_a_student_with_twenty_submissions_waits_for_one_with_a_single_submission():
    waiting = [
        *(arrival(number, 'ada', f'{number}') for number in range(1, 21)),
        arrival(30, 'bob'),
    ]
    starts, served = {}, []
    for at in range(3):
        number = turn(waiting, starts=starts)
        chosen = next(each for each in waiting if each.number == number)
        served.append(chosen.student_id)
        starts.setdefault(chosen.submission_key, []).append(float(at + 1))
        waiting.remove(chosen)
    assert served == ['ada', 'bob', 'ada']


def test_a_lesson_over_its_hourly_limit_waits_and_another_lesson_does_not():
    rules = ResubmissionRules(per_hour=2)
    waiting = [arrival(1, 'ada', 'b'), arrival(2, 'ada', 'a')]
    starts = {('ada', 'a'): [NOW - 100, NOW - 50]}
    assert turn(waiting, starts=starts, rules=rules) == 1
    assert 'the next is graded in 58 min' in reason_to_wait(starts['ada', 'a'], rules, NOW)
    assert reason_to_wait([NOW - 3_700, NOW - 50], rules, NOW) == ''


def test_a_submission_over_the_total_limit_is_kept_but_not_graded():
    rules = ResubmissionRules(in_total=2)
    assert reason_to_wait([1.0], rules, NOW) == ''
    assert reason_to_wait([1.0, 2.0], rules, NOW).endswith('it is kept, but not graded')


def read(text):
    return read_deadlines(f'[resubmissions]\n{text}'.encode(), 'deadlines.toml').resubmissions


def test_resubmission_rules_are_read():
    assert read('per_hour = 6\nin_total = 30\nhidden_inputs = "anew"') == ResubmissionRules(
        6, 30, 'anew'
    )
    assert read('') == NO_RULES


@pytest.mark.parametrize(
    'text', ['per_hour = 0', 'in_total = true', 'in_total = 1.5', 'hidden_inputs = "new"', 'x = 1']
)
def test_invalid_resubmission_rules_are_refused(text):
    with pytest.raises(CourseError, match=text.split()[0]):
        read(text)
