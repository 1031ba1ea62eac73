"""The table [lti] of class.toml: its faults are reported, and a claim is mapped to a user."""

import grp
import os
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from lti_launches import person

ROOT = Path(__file__).parents[1]
DEPLOY = ROOT / 'deploy/jupyterhub'
sys.path.append(str(DEPLOY))

import lti_users  # noqa: E402
from lti_users import LoginRefused, read_login  # noqa: E402

MEMBERS = {'ada', 'bob'}
GOOD = """
issuer = "https://moodle.example.org"
client_id = "AbC123"
authorize_url = "https://moodle.example.org/mod/lti/auth.php"
jwks_endpoint = "https://moodle.example.org/mod/lti/certs.php"
"""


@pytest.fixture(autouse=True)
def class_of_two(monkeypatch):
    monkeypatch.setattr(
        lti_users,
        'is_member',
        lambda name, group: (name, group) in {(m, 'class') for m in MEMBERS},
    )


def login(text=GOOD):
    table = tomllib.loads(text)
    return read_login({'students': 'class', 'instructor': 'ruth', 'lti': table})


@pytest.mark.parametrize(
    ('replaced', 'by', 'said'),
    [
        ('issuer', 'isuer', "'isuer' is not known"),
        (
            'issuer = "https://moodle.example.org"',
            '',
            'issuer is missing, or is not a text in quotes',
        ),
        ('"AbC123"', '5', 'client_id is missing, or is neither'),
        ('"AbC123"', '[]', 'client_id is missing, or is neither'),
        ('"AbC123"', '["a", ""]', 'client_id is missing, or is neither'),
        ('https://moodle.example.org/mod/lti/auth', 'http://m.org/auth', 'authorize_url does not'),
        ('https://moodle.example.org/mod/lti/certs', 'http://m.org/certs', 'anyone on the way'),
        ('issuer', 'username_claim = "email"\nissuer', 'email needs an email_domain'),
        ('issuer', 'username_claim = "given_name"\nissuer', 'given_name is what people call'),
        (
            'issuer',
            'username_claim = ""\nissuer',
            'username_claim is missing, or is not a text in quotes',
        ),
        ('issuer', 'context_id = 2\nissuer', 'context_id is missing, or is not a text in quotes'),
        ('issuer', 'user_ids = {}\nissuer', '[lti.user_ids] is empty'),
        ('issuer', 'user_ids = {ada = 4711}\nissuer', 'write ada = "4711"'),
        ('issuer', 'user_ids = {ada = "1", bob = "1"}\nissuer', 'gives two users the same id'),
        (
            'issuer',
            'user_ids = {ada = "1"}\nusername_claim = "x"\nissuer',
            'either [lti.user_ids]',
        ),
    ],
)
def test_each_fault_in_the_lti_table_is_reported(replaced, by, said):
    login()
    with pytest.raises(ValueError, match=r'docs/lti\.md shows one that is right') as caught:
        login(GOOD.replace(replaced, by, 1))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    'text',
    [
        (DEPLOY / 'class.toml').read_text().partition('# [lti]')[2].replace('\n# ', '\n'),
        (ROOT / 'docs/lti.md').read_text().partition('[lti]\n')[2].partition('```')[0],
    ],
    ids=['class.toml', 'docs/lti.md'],
)
def test_the_example_tables_are_right_and_state_the_default_values(text):
    shown = login(text)
    assert shown.user_of(person('ada') | context('2')) == 'ada'
    assert shown.client_id == {'AbC123'}
    assert replace(shown, context_id='') == login()


def context(number):
    return {f'{lti_users.CLAIM}context': {'id': number}}


def refused(login, claims):
    with pytest.raises(LoginRefused) as caught:
        login.user_of(claims)
    return str(caught.value)


def test_user_ids_of_the_platform_replace_user_names():
    by_id = login(GOOD + 'user_ids = {ada = "4711", ruth = "2", cleo = "5"}')
    assert by_id.user_of(person('bob', user_id='4711')) == 'ada'
    assert by_id.user_of(person('bob', 'Instructor', user_id='2')) == 'ruth'
    assert 'you teach this course' in refused(by_id, person('ruth', user_id='2'))
    assert "sub = '4712', which is nobody in [lti" in refused(by_id, person('ada', user_id='4712'))
    assert 'sub = nothing, which is nobody' in refused(by_id, person('ada', user_id=None))
    assert "no user of this machine in the group 'class'" in refused(
        by_id, person('', user_id='5')
    )


def test_an_email_address_names_a_user_only_in_the_configured_domain():
    by_mail = login(GOOD + 'username_claim = "email"\nemail_domain = "uni.example.org"')
    for address in ('ada@uni.example.org', 'Ada@Uni.Example.ORG'):
        assert by_mail.user_of(person('bob', email=address)) == 'ada'
    for address in (
        'ada@example.org',
        'ada@uni.example.org.evil.example',
        'ada@evil-uni.example.org',
        'ada@evil.example@x.org',
        'ada',
    ):
        said = refused(by_mail, person('ada', email=address))
        assert f"email = '{address}', and only addresses of uni.example.org" in said
    for address in ('bob@x@uni.example.org', '@uni.example.org', 'dan@uni.example.org'):
        assert 'no user of this machine' in refused(by_mail, person('ada', email=address))
    assert 'you teach this course' in refused(by_mail, person('a', email='ruth@uni.example.org'))


@pytest.mark.parametrize('roles', [None, [], 'membership#Instructor', {lti_users.INSTRUCTOR: 1}])
def test_nobody_is_the_instructor_without_a_list_of_roles(roles):
    claims = person('ruth') | {f'{lti_users.CLAIM}roles': roles}
    assert 'you teach this course' in refused(login(), claims)


@pytest.mark.parametrize('custom', [None, 'username', ['username'], {'user': 'ada'}])
def test_a_login_without_the_claim_of_the_user_name_is_refused(custom):
    claims = person('x', user_id='ada') | {f'{lti_users.CLAIM}custom': custom, 'username': 'ada'}
    assert 'custom_username = nothing, expected your name' in refused(login(), claims)


def test_a_long_name_is_shortened_in_the_error():
    said = refused(login(), person('x\n' * 5000))
    assert len(said) < 300
    assert '\n' not in said


def test_is_member_is_true_only_for_a_user_in_the_group(monkeypatch):
    monkeypatch.undo()
    assert lti_users.is_member('daemon', 'daemon')
    listed = {'daemon': [1, grp.getgrnam('adm').gr_gid]}
    with monkeypatch.context() as patch:  # a group that lists the user as a member
        patch.setattr(os, 'getgrouplist', lambda name, primary: listed.get(name, [primary]))
        assert lti_users.is_member('daemon', 'adm')
        assert not lti_users.is_member('bin', 'adm')
    assert not lti_users.is_member('bin', 'daemon')
    assert not lti_users.is_member('daemon', 'no-such-group')
    assert not lti_users.is_member('no-such-user', 'daemon')
    assert not lti_users.is_member('daemon\0', 'daemon')
    assert not lti_users.is_member('', 'daemon')
