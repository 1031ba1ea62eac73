"""Predictions: what a dict must hold, and what is said of the first wrong one."""

import sys
from collections import OrderedDict

import numpy as np
import pytest
from my_robot_basics.checks import CheckFailed, Predictions

KEYS = 'arrives', 'is_lost'


def arrives(stage):
    """the subscription is there"""
    publisher, subscription = stage.publisher('/pose'), stage.subscription('/pose')
    return subscription.heard(publisher.publish())


def is_lost(stage):
    """nobody is there"""
    message = stage.publisher('/pose').publish()
    return stage.subscription('/pose').heard(message)


def predictions(monkeypatch, **answer):
    monkeypatch.setattr(sys.modules['__main__'], 'answer', answer, raising=False)
    return Predictions('answer', KEYS)


@pytest.mark.parametrize('yes', [True, np.bool_(True)])
def test_what_happens_is_right(monkeypatch, yes):
    predictions(monkeypatch, arrives=yes, is_lost=False).compare(arrives, is_lost)


def test_any_dict_will_do_with_keys_of_ones_own(monkeypatch):
    answer = OrderedDict([('note', 'mine'), ('is_lost', False), ('arrives', True)])
    monkeypatch.setattr(sys.modules['__main__'], 'answer', answer, raising=False)
    Predictions('answer', KEYS).compare(arrives, is_lost)


@pytest.mark.parametrize(
    ('answer', 'words'),
    [
        (
            {'arrives': False, 'is_lost': True},
            "expected True for 'arrives' (the message arrived when this was run), saw False: "
            'the subscription is there',
        ),
        (
            {'arrives': True, 'is_lost': True},
            "expected False for 'is_lost' (the message did not arrive when this was run), "
            'saw True: nobody is there',
        ),
    ],
)
def test_the_first_wrong_prediction_is_named_alone(monkeypatch, answer, words):
    with pytest.raises(CheckFailed) as failure:
        predictions(monkeypatch, **answer).compare(arrives, is_lost)
    assert str(failure.value) == words


@pytest.mark.parametrize(
    ('answer', 'words'),
    [
        ({'arrives': True}, "expected the key 'is_lost' in `answer`, saw no such key: write the"),
        ({'arrives': True, 'is lost': False}, "saw 'is lost': write the keys as in the table"),
        ({'arrives': None, 'is_lost': False}, "for 'arrives', saw None: put your prediction"),
        ({'arrives': True, 'is_lost': 'no'}, "for 'is_lost', saw 'no': write True .*, without qu"),
        ({'arrives': 1, 'is_lost': False}, "for 'arrives', saw 1: write True if the message ar"),
        ({'arrives': [], 'is_lost': False}, r"for 'arrives', saw \[\]: write True"),
    ],
)
def test_a_dict_of_another_form_is_said_to_be_so(monkeypatch, answer, words):
    with pytest.raises(CheckFailed, match=words):
        predictions(monkeypatch, **answer)


def test_anything_but_a_dict_is_said_to_be_so(monkeypatch):
    monkeypatch.setattr(sys.modules['__main__'], 'answer', [True, False], raising=False)
    with pytest.raises(CheckFailed, match='expected `answer` to be a dict, saw a list'):
        Predictions('answer', KEYS)
    monkeypatch.delattr(sys.modules['__main__'], 'answer')
    with pytest.raises(CheckFailed, match='expected a value `answer`, saw no such name'):
        Predictions('answer', KEYS)
