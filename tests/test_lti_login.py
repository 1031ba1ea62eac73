"""A real hub, and users sent to it by a platform with LTI 1.3: who may log in, and as whom."""

import html
import re
import time
from concurrent.futures import ThreadPoolExecutor

import jwt
import pytest
import requests
from lti_hub import INSTRUCTOR, OUTSIDER, STUDENT, lti_hub
from lti_launches import CLAIM, Browser, LaunchingPlatform, person
from lti_platform import HANGS_SEC, new_key, served

pytestmark = [pytest.mark.slow, pytest.mark.starts]
SOMEBODY = 'https://elsewhere.example.org'
MADE_UP = jwt.encode({}, 'x' * 64, 'HS256', headers={'kid': 'made-up'})
PEOPLE = {
    'student': person(STUDENT),
    'instructor': person(INSTRUCTOR, 'Instructor', user_id='2'),
    'posing as the instructor': person(INSTRUCTOR, 'Learner', 'Mentor'),
    'unknown': person('ada-of-nowhere'),
    'no member': person(OUTSIDER),
    'no member, who teaches': person(OUTSIDER, 'Instructor'),
    'root': person('root', 'Instructor'),
    'other letters': person(STUDENT.upper()),
    'html': person('<b>%s'),
    'no text': person([STUDENT]),
    'nobody': person(None, user_id=STUDENT, email=STUDENT, name=STUDENT),
    'of many names': person(
        STUDENT, given_name=INSTRUCTOR, email=f'{INSTRUCTOR}@x.org', preferred_username=INSTRUCTOR
    ),
    'in another course': person(STUDENT) | {f'{CLAIM}context': {'id': '3'}},
}


@pytest.fixture(scope='module')
def running_hub():
    platform = LaunchingPlatform()
    platform.people = PEOPLE
    with served(platform), lti_hub(platform):
        yield platform


@pytest.fixture
def platform(running_hub):
    good = dict(vars(running_hub))
    running_hub.changed = {}
    yield running_hub
    vars(running_hub).update(good)


@pytest.fixture
def browser(platform):
    return Browser(platform)


def said(answer):
    """The sentence on a page of the hub that refuses something."""
    found = re.search(r'<div class="error">.*?<p>(.*?)</p>', answer.text, re.DOTALL)
    return html.unescape(found[1])


@pytest.mark.parametrize('method', ['GET', 'POST'])
def test_a_student_who_follows_the_link_is_a_user_of_this_machine(method, browser, platform):
    assert browser.user() == ''
    answer = browser.log_in('student', method=method)
    assert (answer.status_code, answer.headers['Location']) == (302, '/hub/')
    assert browser.user() == STUDENT
    assert Browser(platform).user() == ''


def test_each_login_has_a_nonce_and_a_state_of_its_own(browser, platform):
    asked = len(platform.asked)
    for _ in range(2):
        browser.log_in('student')
    first, second = platform.asked[asked:]
    assert first['nonce'] != second['nonce']
    assert first['state'] != second['state']


def test_other_names_in_a_persons_profile_do_not_change_the_user(browser):
    browser.log_in('of many names')
    assert browser.user() == STUDENT


def test_an_instructor_on_the_platform_is_logged_in_as_the_instructor(browser):
    assert browser.log_in('instructor').status_code == 302
    assert browser.user() == INSTRUCTOR


@pytest.mark.parametrize(
    ('who', 'why'),
    [
        ('posing as the instructor', f"custom_username = '{INSTRUCTOR}', which is the instructor"),
        ('unknown', "custom_username = 'ada-of-nowhere', and no user of this machine in the gr"),
        ('no member', f"custom_username = '{OUTSIDER}', and no user of this machine in the group"),
        ('no member, who teaches', f"'{OUTSIDER}', and no user of this machine in the group"),
        ('root', "custom_username = 'root', and no user of this machine in the group"),
        ('other letters', f"custom_username = '{STUDENT.upper()}', and no user of this machine"),
        ('html', "custom_username = '<b>%s', and no user of this machine"),
        ('no text', f"custom_username = ['{STUDENT}'], expected your name: ask the instructor"),
        ('nobody', 'custom_username = nothing, expected your name: ask the instructor to let'),
        ('in another course', "from its course '3', and this hub is for '2': follow the link th"),
    ],
)
def test_a_person_without_an_account_reads_the_claim_and_what_to_do(who, why, browser):
    answer = browser.log_in(who)
    assert answer.status_code == 403
    assert why in said(answer)
    assert '<b>%s' not in answer.text
    assert browser.user() == ''


# --- what the platform did not sign, or not for this login ------------------------------------


@pytest.mark.parametrize(
    ('changed', 'status', 'why'),
    [
        ({'nonce': 'f' * 64}, 400, 'nonce mismatch'),
        ({'nonce': None}, 400, 'arg nonce not in request'),
        ({'aud': 'another-tool'}, 401, "Audience doesn't match"),
        ({'aud': None}, 400, 'missing the "aud" claim'),
        ({'iss': SOMEBODY}, 400, 'Invalid issuer'),
        ({'iss': None}, 400, 'missing the "iss" claim'),
        ({'exp': int(time.time()) - 5}, 400, 'expired'),
        ({'exp': None}, 400, 'arg exp not in request'),
        ({'iat': int(time.time()) - 3600}, 400, 'too long ago'),
        ({f'{CLAIM}message_type': 'LtiSubmissionReviewRequest'}, 400, 'message_type'),
    ],
)
def test_a_token_with_a_wrong_claim_lets_nobody_in(changed, status, why, browser, platform):
    platform.changed = changed
    answer = browser.log_in('student')
    assert (answer.status_code, why in said(answer)) == (status, True), said(answer)
    assert browser.user() == ''


@pytest.mark.parametrize('kid', ['of the platform', 'of somebody'])
def test_a_token_that_another_key_signed_lets_nobody_in(kid, browser, platform, monkeypatch):
    form = browser.follow_link('student')
    claims = jwt.decode(form['id_token'], options={'verify_signature': False})
    headers = {'kid': platform.kid if kid == 'of the platform' else 'made-up'}
    form['id_token'] = jwt.encode(claims, new_key()[0], 'RS256', headers=headers)
    answer = browser.send(form)
    wanted = 'Signature verification failed' if kid == 'of the platform' else 'signing key'
    assert (answer.status_code, wanted in said(answer)) == (400, True), said(answer)
    assert browser.user() == ''


@pytest.mark.parametrize('algorithm', ['none', 'HS256'])
def test_a_token_that_needs_no_private_key_lets_nobody_in(algorithm, browser, platform):
    form = browser.follow_link('student')
    claims = jwt.decode(form['id_token'], options={'verify_signature': False})
    secret = None if algorithm == 'none' else 'x' * 64
    form['id_token'] = jwt.encode(claims, secret, algorithm, headers={'kid': platform.kid})
    answer = browser.send(form)
    assert answer.status_code == 400
    assert 'alg' in said(answer)
    assert browser.user() == ''


def test_the_key_of_a_platform_may_change(browser, platform):
    platform.key, platform.public = new_key()
    platform.kid = 'the next one'
    assert browser.log_in('student').status_code == 302


def test_a_token_for_one_browser_lets_no_other_browser_in(browser, platform):
    form = browser.follow_link('student')
    thief = Browser(platform)
    assert said(thief.send(form)) == 'OAuth state missing from cookies'
    thief.follow_link('unknown')
    assert said(thief.send(form)) == 'OAuth state mismatch'
    theirs = thief.follow_link('unknown')
    assert said(thief.send(form | {'state': theirs['state']})) == 'OAuth nonce mismatch'
    assert thief.user() == ''
    assert browser.send(form).status_code == 302


def test_the_hub_keeps_users_and_admits_nobody_while_the_platform_is_away(browser, platform):
    there = Browser(platform)
    there.log_in('student')
    form = browser.follow_link('student')
    platform.mood = '500'
    answer = browser.send(form)
    assert (answer.status_code, '500' in said(answer)) == (400, True), said(answer)
    assert browser.user() == ''
    assert there.user() == STUDENT
    platform.mood = 'well'
    assert browser.log_in('student').status_code == 302


def test_the_hub_answers_others_while_the_platform_is_slow(browser, platform):
    """A login fetches the platform's keys, also for a token that anybody has made up."""
    form = browser.follow_link('student')
    platform.mood = 'hangs'
    with ThreadPoolExecutor() as threads:
        asked = len(platform.requests)
        login = threads.submit(browser.send, form | {'id_token': MADE_UP})
        while len(platform.requests) == asked:
            time.sleep(0.01)
        began = time.monotonic()
        assert requests.get(f'{platform.tool}/hub/health').status_code == 200
        took_sec = time.monotonic() - began
        assert not login.done()
        assert login.result().status_code == 400
    assert took_sec < HANGS_SEC / 2


def test_the_login_page_names_the_link_to_follow_and_takes_no_password(browser, platform):
    page = browser.session.get(f'{platform.tool}/hub/login')
    assert 'Follow the link to this hub in your course on the learning platform.' in page.text
    assert 'type="password"' not in page.text


def test_a_target_link_outside_the_hub_is_not_followed(browser):
    answer = browser.log_in('student', target_link_uri=f'{SOMEBODY}//x/hub/home')
    assert answer.headers['Location'].startswith('/x/')


def test_the_proxy_loses_none_of_many_quick_answers(browser, platform):
    """Without keep_alive.cjs, the proxy lost 34 of 500 such answers."""
    there = f'{platform.tool}/hub/lti13/oauth_callback'
    form = {'state': 'none', 'id_token': 'none'}
    answers = {browser.session.post(there, data=form).status_code for _ in range(200)}
    assert answers == {400}
