"""Inputs are the same for one seed and label, and differ each time if there is no seed."""

import pytest
from my_robot_basics.checks import inputs


def draw(label):
    return inputs(label).random()


def test_a_label_gives_the_same_inputs_for_the_same_seed(monkeypatch):
    monkeypatch.setenv('MY_ROBOT_BASICS_SEED', 'c0ffee')
    assert draw('reach') == draw('reach') != draw('other')
    before = draw('reach')
    monkeypatch.setenv('MY_ROBOT_BASICS_SEED', 'decade')
    assert draw('reach') != before


@pytest.mark.parametrize('seed', ['', None])
def test_inputs_differ_each_time_without_a_seed(monkeypatch, seed):
    monkeypatch.delenv('MY_ROBOT_BASICS_SEED', raising=False)
    if seed is not None:
        monkeypatch.setenv('MY_ROBOT_BASICS_SEED', seed)
    assert draw('reach') != draw('reach')
