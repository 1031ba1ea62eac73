"""A response reaches a client that a busy machine makes known late."""

import warnings

import pytest
from my_robot_basics.checks import sending
from my_robot_basics.checks.sending import ATTEMPTS, send_until_met

LOST = 'failed to send response (timeout)'


def lost_so_often(times, sent):
    def send():
        sent.append('a response')
        if len(sent) <= times:
            warnings.warn(f'{LOST}: client will not receive response', stacklevel=1)

    return send


@pytest.mark.parametrize(('lost', 'sent_times'), [(0, 1), (3, 4), (1_000, ATTEMPTS)])
def test_a_response_is_sent_again_until_its_client_is_met(recwarn, lost, sent_times):
    sent = []
    send_until_met(lost_so_often(lost, sent))
    assert len(sent) == sent_times
    assert not recwarn.list


def test_another_warning_is_shown(monkeypatch):
    shown = []
    monkeypatch.setattr(
        sending.warnings, 'showwarning', lambda message, *_: shown.append(str(message))
    )
    send_until_met(lambda: warnings.warn('something else', stacklevel=1))
    assert shown == ['something else']
