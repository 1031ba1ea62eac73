"""Two messages in quick succession, and what a busy machine makes of them."""

from itertools import count
from types import SimpleNamespace

import pytest
from my_robot_basics.checks import passage
from my_robot_basics.checks.passage import Passage
from my_robot_basics.checks.variety import Sent


class Node:
    """Lets out what it receives at once, but only the second of those pairs, counted from 0."""

    def __init__(self, loses):
        self.loses, self.received, self.numbers = loses, [], count()

    def publish(self, message):
        number = next(self.numbers)
        if not (number % 2 == 0 and self.loses(number // 2)):
            self.received.append(message)

    def messages(self):
        return self.received


def loses_one_of_two(loses):
    watcher = SimpleNamespace(
        spin_for=lambda _: None, spin_until_free=lambda done, free_sec: done()
    )
    node = Node(loses)
    over = Passage(watcher, node, publish=node.publish, what=lambda message: message)
    return over.loses_one_of_two(Sent(number, '') for number in count())


@pytest.fixture(params=[False, True], ids=['free', 'busy'])
def is_busy(request, monkeypatch):
    monkeypatch.setattr(passage.Stopwatch, 'is_busy', lambda _: request.param)
    return request.param


@pytest.mark.usefixtures('is_busy')
@pytest.mark.parametrize('loses', [lambda pair: False, lambda pair: pair < 4])
def test_who_loses_the_first_pairs_alone_keeps_both(loses):
    assert not loses_one_of_two(loses)


@pytest.mark.usefixtures('is_busy')
@pytest.mark.parametrize('loses', [lambda pair: True, lambda pair: pair % 15 != 5])
def test_who_mostly_lets_out_one_of_two_loses_the_other(loses):
    assert loses_one_of_two(loses)


def test_a_busy_machine_may_lose_most_pairs_of_a_short_queue(is_busy):
    assert loses_one_of_two(lambda pair: pair < 6 or pair % 3) == (not is_busy)
