"""Scores go to a learning platform by LTI 1.3 when they change, each once, and none is lost."""

import json

import jwt
import pytest
from course_maker import released_course
from lti_platform import CLIENT, LtiPlatform, new_key, served

from grader.__main__ import main
from grader.common.errors import CourseError
from grader.passback import lti, lti_platform
from grader.passback.lti_platform import public_jwk
from grader.passback.lti_queue import Score, opened_lti_queue
from grader.passback.lti_settings import read_settings
from grader.storage.records import CellScore

LESSON, OTHER = '03_publisher', '04_subscriber'
SETTINGS = """\
issuer = "https://moodle.example.org"
client_id = "{client}"
token_url = "{address}/token"
lineitems = "{address}/lineitems"
key_file = "lti_key.pem"

[user_ids]
ada = "4711"
bob = "4712"
cleo = "4713"
"""
KEYS = new_key()


def cell(student, score, assignment=LESSON, most=5.0):
    return CellScore(student, assignment, 'check', score, most)


def sent(column, user, score, most=5.0):
    return f'/lineitems/{column}', user, score, most


@pytest.fixture
def platform():
    platform = LtiPlatform(KEYS[1])
    with served(platform):
        yield platform


@pytest.fixture
def given(tmp_path, monkeypatch, platform):
    """A course of which `given(*cells)` sends these scores, and returns the exit status."""
    course = released_course(tmp_path)
    course.gradebook.mkdir(exist_ok=True)
    monkeypatch.setattr(lti_platform, 'TIMEOUT', (0.5, 0.5))
    write(course, SETTINGS.format(client=CLIENT, address=platform.address))

    def send(*cells, assignment=()):
        monkeypatch.setattr(lti, 'records', lambda course: list(cells))
        return main(['scores', *assignment, '--send', 'lti'], course=course)

    send.course = course
    return send


def write(course, settings, key=KEYS[0], mode=0o600):
    (course.gradebook / 'lti.toml').write_text(settings)
    (course.gradebook / 'lti_key.pem').write_text(key)
    (course.gradebook / 'lti_key.pem').chmod(mode)


def test_each_score_is_sent_once_and_again_when_it_changes(given, platform, capsys):
    assert given(cell('ada', 4.0), cell('bob', 2.5), cell('ada', 1.0, OTHER)) == 0
    assert capsys.readouterr().out == '3 scores sent, 0 waiting\n'
    assert [each['tag'] for each in platform.columns.values()] == [LESSON, OTHER]
    first = [sent(1, '4711', 4.0), sent(2, '4711', 1.0), sent(1, '4712', 2.5)]
    assert sorted(platform.received) == sorted(first)
    asked = len(platform.requests)

    assert given(cell('ada', 4.0), cell('bob', 2.5), cell('ada', 1.0, OTHER)) == 0
    assert len(platform.requests) == asked  # nothing has changed: no request

    assert given(cell('ada', 4.0), cell('bob', 5.0), cell('ada', 1.0, OTHER)) == 0
    assert platform.received[3:] == [sent(1, '4712', 5.0)]
    assert len(platform.columns) == 2


def test_one_token_is_enough_for_a_class(given, platform):
    given(cell('ada', 4.0), cell('bob', 2.5), cell('cleo', 1.0))
    assert platform.requests.count('POST /token') == 1


def test_a_token_that_is_about_to_expire_is_replaced(given, platform):
    platform.token_seconds = 10
    assert given(cell('ada', 4.0), cell('bob', 2.5)) == 0
    assert platform.requests.count('POST /token') > 1


def test_only_final_scores_are_sent_and_the_other_students_are_listed(given, platform, capsys):
    assert given(cell('ada', None), cell('dan', 3.0), cell('bob', -1.0)) == 0
    said = capsys.readouterr().out
    assert f'{LESSON}: ada needs manual grading' in said
    assert f'{LESSON}: dan is not in [user_ids] of lti.toml' in said
    assert platform.received == [sent(1, '4712', 0.0)]  # no platform accepts a negative score


def test_the_scores_of_one_assignment_can_be_sent(given, platform, capsys):
    cells = cell('ada', 4.0), cell('ada', 1.0, OTHER)
    assert given(*cells, assignment=[OTHER]) == 0
    assert platform.received == [sent(1, '4711', 1.0)]
    assert given(*cells, assignment=['05_command_line']) == 1
    assert "there is no assignment '05_command_line' in solutions/" in capsys.readouterr().err


@pytest.mark.parametrize(
    ('mood', 'why'),
    [
        ('500', 'it answered 500: {"error": "the database is away"}'),
        ('hangs', 'Timeout'),
        ('talks nonsense', 'an answer that is not in the format of LTI'),
    ],
)
def test_no_score_is_lost_while_the_platform_fails_to_answer(mood, why, given, platform, capsys):
    platform.mood = mood
    assert given(cell('ada', 4.0), cell('bob', 2.5)) == 1
    said = capsys.readouterr().out
    assert f'the platform did not answer as expected: {why}' in said or (
        mood == 'hangs' and why in said
    )
    assert '0 scores sent, 2 waiting\nNothing is lost.' in said
    assert len(platform.requests) == 1  # not one for each student

    platform.mood = 'well'
    assert given(cell('ada', 4.5), cell('bob', 2.5)) == 0
    assert sorted(platform.received) == [sent(1, '4711', 4.5), sent(1, '4712', 2.5)]


def test_no_score_is_lost_if_the_platform_refuses_connections(given, platform, capsys):
    port = int(platform.address.rpartition(':')[2])
    there = SETTINGS.format(client=CLIENT, address=f'http://127.0.0.1:{free_port()}')
    write(given.course, there)
    assert given(cell('ada', 4.0)) == 1
    assert 'the platform did not answer as expected: ConnectionError' in capsys.readouterr().out
    write(given.course, SETTINGS.format(client=CLIENT, address=f'http://127.0.0.1:{port}'))
    assert given(cell('ada', 4.0)) == 0
    assert platform.received == [sent(1, '4711', 4.0)]


def free_port():
    platform = LtiPlatform(KEYS[1])
    with served(platform) as port:
        return port


def test_a_score_whose_answer_was_lost_is_not_counted_as_refused(given, platform, capsys):
    given(cell('bob', 1.0))
    platform.mood = 'loses answers'
    assert given(cell('bob', 1.0), cell('ada', 4.0)) == 1
    platform.mood = 'well'
    assert given(cell('bob', 1.0), cell('ada', 4.0)) == 0
    assert platform.received == [sent(1, '4712', 1.0), sent(1, '4711', 4.0)]


def test_a_score_is_sent_again_if_the_sender_was_killed_before_the_response(
    given, platform, monkeypatch
):
    def killed(self, score):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(lti_platform.LtiService, 'send', killed)
        assert given(cell('ada', 4.0)) == 130
    assert given(cell('ada', 4.0)) == 0
    assert platform.received == [sent(1, '4711', 4.0)]


def test_a_newer_score_on_the_platform_stays_and_the_refusal_is_reported(given, platform, capsys):
    given(cell('ada', 4.0))
    platform.scores['/lineitems/1', '4711']['timestamp'] = '2999-01-01T00:00:00+00:00'
    assert given(cell('ada', 5.0)) == 1
    assert f'{LESSON}: ada: the score was refused: it answered 409' in capsys.readouterr().out
    assert given(cell('ada', 5.0)) == 1
    assert platform.received == [sent(1, '4711', 4.0)]


def test_a_refused_score_does_not_hold_up_other_students(given, platform, capsys):
    platform.users.remove('4711')
    assert given(cell('ada', 4.0), cell('bob', 2.5)) == 1
    said = capsys.readouterr().out
    why = 'it answered 400: {"error": "4711 is not enrolled"}'
    assert f'{LESSON}: ada: the score was refused: {why}' in said
    assert '1 scores sent, 1 waiting' in said
    platform.users.add('4711')
    assert given(cell('ada', 4.0), cell('bob', 2.5)) == 0
    assert platform.received == [sent(1, '4712', 2.5), sent(1, '4711', 4.0)]


@pytest.mark.parametrize('wrong', ['key', 'client', 'audience'])
def test_no_token_is_given_for_a_wrong_key_client_or_audience(wrong, given, platform, capsys):
    settings = SETTINGS.format(
        client='somebody' if wrong == 'client' else CLIENT, address=platform.address
    )
    if wrong == 'audience':
        settings = f'audience = "https://elsewhere.example.org"\n{settings}'
    write(given.course, settings, key=new_key()[0] if wrong == 'key' else KEYS[0])
    assert given(cell('ada', 4.0)) == 1
    assert 'it answered 401' in capsys.readouterr().out
    assert platform.received == []


def test_changes_are_in_order_even_if_the_clock_goes_back(tmp_path):
    with opened_lti_queue(tmp_path) as queue:
        queue.note([Score('ada', LESSON, '4711', 1.0, 5.0, 2000.0)])
        queue.note([Score('ada', LESSON, '4711', 2.0, 5.0, 1000.0)])
        (waiting,) = queue.waiting()
        assert (waiting.score, waiting.changed > 2000.0) == (2.0, True)


def test_a_score_that_changed_while_it_was_sent_still_waits(tmp_path):
    with opened_lti_queue(tmp_path) as queue:
        queue.note([Score('ada', LESSON, '4711', 1.0, 5.0, 1000.0)])
        (old,) = queue.waiting()
        queue.note([Score('ada', LESSON, '4711', 2.0, 5.0, 2000.0)])
        queue.note_sent(old)
        assert [each.score for each in queue.waiting()] == [2.0]


# --- settings ------------------------------------------------------------------------------------


GOOD = SETTINGS.format(client=CLIENT, address='https://moodle.example.org')


@pytest.mark.parametrize(
    ('replaced', 'by', 'said'),
    [
        ('https://moodle.example.org/token', 'http://moodle.example.org/token', 'token_url does'),
        ('issuer', 'isuer', "'isuer' is not a name that this file can have"),
        ('client_id = "course-of-the-arm"', '', 'client_id is missing'),
        ('ada = "4711"', 'ada = 4711', 'write ada = "4711"'),
        ('"4712"', '"4711"', 'gives two students the same id'),
        ('[user_ids]', 'students_are_user_ids = 1', 'neither true nor false'),
        ('"lti_key.pem"', '"none.pem"', 'none.pem cannot be read'),
        ('[user_ids]', '[user_ids', 'cannot be read'),
    ],
)
def test_each_fault_in_the_settings_is_reported(replaced, by, said, tmp_path):
    course = released_course(tmp_path)
    course.gradebook.mkdir(exist_ok=True)
    write(course, GOOD)
    read_settings(course)
    changed = GOOD.replace(replaced, by)
    if by == 'students_are_user_ids = 1':
        changed = changed.partition(by)[0] + by
    write(course, changed)
    with pytest.raises(CourseError) as caught:
        read_settings(course)
    assert said in str(caught.value)


def test_a_key_that_others_may_read_is_refused(tmp_path):
    course = released_course(tmp_path)
    course.gradebook.mkdir(exist_ok=True)
    write(course, GOOD, mode=0o644)
    with pytest.raises(CourseError, match='chmod 600'):
        read_settings(course)


def test_sending_without_settings_fails_and_names_the_documentation(tmp_path, capsys):
    course = released_course(tmp_path)
    assert main(['scores', '--send', 'lti'], course=course) == 1
    assert 'docs/lti.md shows one' in capsys.readouterr().err


def test_students_may_be_named_by_the_user_ids_of_the_platform(tmp_path):
    course = released_course(tmp_path)
    course.gradebook.mkdir(exist_ok=True)
    text = 'students_are_user_ids = true\n' + GOOD.replace('cleo', 'dora')
    write(course, text)
    settings = read_settings(course)
    assert (settings.user_id_of('dora'), settings.user_id_of('4713')) == ('4713', '4713')
    assert KEYS[0] not in repr(settings)


def test_the_key_that_is_shown_is_the_public_one():
    jwk = public_jwk(KEYS[0])
    assert {'kty', 'n', 'e', 'kid', 'alg', 'use'} == {*jwk}
    signed = jwt.encode({'a': 1}, KEYS[0], algorithm='RS256')
    shown = jwt.PyJWK.from_json(json.dumps(dict(jwk)))
    assert jwt.decode(signed, shown.key, algorithms=['RS256']) == {'a': 1}
