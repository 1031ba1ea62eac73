"""What a check knows of a server's earlier answers to goals, also in other grade cells."""

import pytest
from my_robot_basics.checks.actions import goal_answers
from my_robot_basics.checks.actions.goal_answers import GoalAnswers, answers_of, note_answer

SERVER, OTHER = ((1, 2),), ((3, 4),)


@pytest.fixture(autouse=True)
def _nobody_is_known(monkeypatch):
    monkeypatch.setattr(goal_answers, '_answers', {})


def test_a_rejection_keeps_the_time_of_the_last_accepted_goal():
    note_answer(SERVER, sent_ns=5, is_accepted=True)
    note_answer(SERVER, sent_ns=7, is_accepted=False)
    assert answers_of(SERVER) == GoalAnswers(5, has_rejected_last=True)
    assert answers_of(OTHER) == GoalAnswers()


def test_the_reason_of_a_rejection_is_kept_until_a_goal_is_accepted():
    note_answer(SERVER, sent_ns=3, is_accepted=True)
    note_answer(SERVER, sent_ns=5, is_accepted=False)
    goal_answers.note_why_rejected(SERVER, 'the flag')
    note_answer(SERVER, sent_ns=7, is_accepted=False)
    assert answers_of(SERVER) == GoalAnswers(3, has_rejected_last=True, why_rejected='the flag')
    note_answer(SERVER, sent_ns=9, is_accepted=True)
    assert answers_of(SERVER) == GoalAnswers(9)
