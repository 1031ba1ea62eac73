"""Predictions: what a dict must hold, what is said about wrong ones, which points remain."""

import ast
import math
import re
import sys
from collections import OrderedDict

import numpy as np
import pytest
from my_robot_basics.checks import CheckFailed, Predictions
from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.errors import PartlyRight
from my_robot_basics.graph import watcher as stage_watchers

from grader.course import ROOT

KEYS = 'arrives', 'is_lost'


def arrives(stage):
    """the subscription is there"""
    publisher, subscription = stage.publisher('/pose'), stage.subscription('/pose')
    return subscription.received(publisher.publish())


def is_lost(stage):
    """nobody is there"""
    message = stage.publisher('/pose').publish()
    return stage.subscription('/pose').received(message)


def predictions(monkeypatch, **answer):
    monkeypatch.setattr(sys.modules['__main__'], 'answer', answer, raising=False)
    return Predictions('answer', KEYS)


def concluded(predictions, *situations):
    predictions.run(*situations)
    predictions.conclude(points={2: 2, 1: 1})


@pytest.mark.parametrize('yes', [True, np.bool_(True)])
def test_predictions_that_match_what_happens_pass(monkeypatch, yes):
    concluded(predictions(monkeypatch, arrives=yes, is_lost=False), arrives, is_lost)


def test_any_kind_of_dict_with_additional_keys_passes(monkeypatch):
    answer = OrderedDict([('note', 'mine'), ('is_lost', False), ('arrives', True)])
    monkeypatch.setattr(sys.modules['__main__'], 'answer', answer, raising=False)
    concluded(Predictions('answer', KEYS), arrives, is_lost)


EXPECTED = 'expected each prediction to match what happens when the check runs it'


def test_each_wrong_prediction_is_named_with_its_reason(monkeypatch):
    with pytest.raises(CheckFailed) as failure:
        concluded(predictions(monkeypatch, arrives=False, is_lost=True), arrives, is_lost)
    assert str(failure.value) == (
        f'{EXPECTED}, saw 2 wrong: `arrives` arrives (the subscription is there); '
        '`is_lost` does not arrive (nobody is there)'
    )
    assert not isinstance(failure.value, PartlyRight)


def test_enough_right_predictions_leave_points(monkeypatch):
    with pytest.raises(PartlyRight) as failure:
        concluded(predictions(monkeypatch, arrives=True, is_lost=True), arrives, is_lost)
    assert str(failure.value) == (
        f'{EXPECTED}, saw 1 wrong, which leaves 1 of 2 points: '
        '`is_lost` does not arrive (nobody is there)'
    )


@pytest.mark.parametrize(('arrives_too', 'told'), [(True, []), (False, ['already'])])
def test_the_grader_learns_whether_a_visible_prediction_was_wrong(monkeypatch, arrives_too, told):
    displayed = []
    monkeypatch.setattr(hidden, '_display', lambda mime, text: displayed.append(text))
    monkeypatch.setattr(hidden, '_quiet', False)
    monkeypatch.setattr(hidden, 'is_in_test_room', lambda: True)
    monkeypatch.setattr(stage_watchers, 'is_in_test_room', lambda: False)
    predicted = predictions(monkeypatch, arrives=arrives_too, is_lost=True)
    predicted.run(arrives)
    hidden.begin_hidden_part()
    predicted.run(is_lost)
    with pytest.raises(CheckFailed):
        predicted.conclude(points={2: 2})
    assert [text for text in displayed if text == 'already'] == told


def test_wrong_predictions_leave_no_points_if_only_a_part_was_run(monkeypatch):
    with pytest.raises(CheckFailed) as failure:
        concluded(predictions(monkeypatch, arrives=False, is_lost=False), arrives)
    assert str(failure.value).startswith(f'{EXPECTED}, saw 1 of the 1 that this part runs wrong: ')
    assert not isinstance(failure.value, PartlyRight)


def test_guessing_earns_next_to_nothing_in_lesson_1():
    """Of nine predictions two are known from the visible part; the rest are thrown."""
    lesson = (ROOT / 'solutions/01_topics/01_topics.ipynb').read_text(encoding='utf-8')
    ((left,),) = [re.findall(r'predictions\.conclude\(points=({.+?})\)', lesson)]
    points = ast.literal_eval(left)
    assert max(points) == 9
    thrown = [math.comb(7, right) / 2**7 for right in range(8)]
    earned = [
        max((p for n, p in points.items() if n <= 2 + right), default=0) for right in range(8)
    ]
    assert sum(p * n for p, n in zip(thrown, earned, strict=True)) < 0.25


@pytest.mark.parametrize(
    ('answer', 'words'),
    [
        ({'arrives': True}, "expected the key 'is_lost' in `answer`, saw no such key: write the"),
        ({'arrives': True, 'is lost': False}, "saw 'is lost': write the keys as in the table"),
        ({'arrives': True, 'IS_LOST': False}, "saw 'IS_LOST': write the keys as in the table"),
        ({'arrives': None, 'is_lost': False}, "for 'arrives', saw None: put your prediction"),
        ({'arrives': True, 'is_lost': 'no'}, "for 'is_lost', saw 'no': write True .*, without qu"),
        ({'arrives': 1, 'is_lost': False}, "for 'arrives', saw 1: write True if the message ar"),
        ({'arrives': [], 'is_lost': False}, r"for 'arrives', saw \[\]: write True"),
    ],
)
def test_a_dict_of_the_wrong_form_fails_with_advice(monkeypatch, answer, words):
    with pytest.raises(CheckFailed, match=words):
        predictions(monkeypatch, **answer)


def test_an_answer_that_is_no_dict_fails(monkeypatch):
    monkeypatch.setattr(sys.modules['__main__'], 'answer', [True, False], raising=False)
    with pytest.raises(CheckFailed, match='expected `answer` to be a dict, saw a list'):
        Predictions('answer', KEYS)
    monkeypatch.delattr(sys.modules['__main__'], 'answer')
    with pytest.raises(CheckFailed, match='expected a value for `answer`, saw no such name'):
        Predictions('answer', KEYS)
