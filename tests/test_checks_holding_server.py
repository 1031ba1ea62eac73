"""How many requests of a client are too many while a check's server holds its responses back."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.services import holding_server
from my_robot_basics.checks.services.holding_server import MOST_HELD, HoldingServer


@pytest.fixture
def answered(monkeypatch):
    """A function: hold for so many seconds, and return the requests that are answered then.

    They are sent `apart_sec` after each other, whenever the check reads them.
    """

    def release(*requests, held_sec, apart_sec=0.1, reverse=False):
        now, sent = [100.0], []
        monkeypatch.setattr(holding_server, 'time', SimpleNamespace(monotonic=lambda: now[0]))
        service = SimpleNamespace(send_response=lambda response, _: sent.append(response))
        node = SimpleNamespace(create_service=lambda *_: service)
        server = HoldingServer(node, name='/solve_ik', type_=object, answer=lambda asked: asked)
        server.start()
        server.hold()
        server.published += sorted({*requests})
        for number, each in enumerate(requests):
            header = SimpleNamespace(source_timestamp=round(number * apart_sec * 1e9))
            service.send_response(server._take(each, None), header)
        assert not sent
        now[0] += held_sec
        server.release(reverse=reverse)
        return sent

    return release


HELD_SEC = 1.5, 4.0, 10.0
"""How long responses are held back on an idle machine, and on busy ones."""


@pytest.mark.parametrize('held_sec', HELD_SEC)
@pytest.mark.parametrize('period_sec', [1.0, 0.5, 0.25])
def test_a_client_that_repeats_two_requests_gets_both_answers(answered, period_sec, held_sec):
    asked = ['a', 'b'] * (1 + round(held_sec / period_sec))
    sent = answered(*asked, held_sec=held_sec)
    assert sent == asked[-MOST_HELD:]


@pytest.mark.parametrize('held_sec', HELD_SEC)
def test_a_client_that_asks_in_a_loop_is_reported(answered, held_sec):
    asked = ['a', 'b'] * (1 + round(held_sec / 0.1))
    with pytest.raises(CheckFailed, match='ask once in the callback, not in a loop or a timer'):
        answered(*asked, held_sec=held_sec)


def test_a_few_responses_are_all_sent_in_the_order_that_was_asked_for(answered):
    assert answered('a', 'b', 'c', held_sec=1.0) == ['a', 'b', 'c']
    assert answered('a', 'b', 'c', held_sec=1.0, reverse=True) == ['c', 'b', 'a']


@pytest.mark.parametrize('held_sec', HELD_SEC)
def test_a_client_that_asks_many_times_for_each_message_is_reported(answered, held_sec):
    asked = ['a'] * (MOST_HELD + 1) + ['b'] * (MOST_HELD + 1)
    with pytest.raises(CheckFailed, match='ask once in the callback, not in a loop or a timer'):
        answered(*asked, held_sec=held_sec, apart_sec=0.001)
