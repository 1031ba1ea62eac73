"""The small platform launches a tool by LTI 1.3, with its own keys or with wrong ones."""

import html
import json
import re
import time
from urllib.parse import parse_qs, urlsplit
from uuid import uuid4

import jwt
import requests
from lti_platform import CLIENT, LtiPlatform, new_key

CLAIM = 'https://purl.imsglobal.org/spec/lti/claim/'
ROLE = 'http://purl.imsglobal.org/vocab/lis/v2/membership#'
COURSE = '2'
FORM = """<!DOCTYPE html><form method="post" action="{action}">
<input type="hidden" name="id_token" value="{id_token}">
<input type="hidden" name="state" value="{state}">
</form><script>document.forms[0].submit()</script>"""
FIELD = re.compile(r'(?:name|action)="(\w+|http[^"]+)"(?: value="([^"]*)")?')


class LaunchingPlatform(LtiPlatform):
    """A platform whose users follow the link to one tool, `tool`."""

    def __init__(self):
        super().__init__(public=None)
        self.key, self.public = new_key()
        self.kid = uuid4().hex
        self.algorithm = 'RS256'
        self.tool = ''
        """The URL of the tool, as it was registered."""
        self.people = {}
        """By login_hint: the claims about a person."""
        self.changed = {}
        """Wrong claims for the next id_tokens; None leaves a claim out."""
        self.asked = []
        """The authentication requests that were valid."""

    def page(self, path, query):
        if path == '/jwks':
            return 200, 'application/json', json.dumps({'keys': [self.jwk()]})
        if path != '/auth':
            return None
        asked = {name: values[0] for name, values in query.items()}
        wanted = {
            'response_type': 'id_token',
            'scope': 'openid',
            'response_mode': 'form_post',
            'prompt': 'none',
            'client_id': CLIENT,
            'redirect_uri': f'{self.tool}/hub/lti13/oauth_callback',
            'lti_message_hint': 'link 7',
        }
        if wrong := {name: asked.get(name) for name in wanted if asked.get(name) != wanted[name]}:
            return 400, 'text/plain', f'wrong: {wrong}'
        if asked['login_hint'] not in self.people or not asked.get('state'):
            return 400, 'text/plain', 'nobody, or no state'
        self.asked.append(asked)
        form = {'id_token': self.id_token(asked), 'action': asked['redirect_uri']}
        escaped = {name: html.escape(text) for name, text in (asked | form).items()}
        return 200, 'text/html', FORM.format(**escaped)

    def jwk(self):
        """Return the public key with which a tool verifies the platform's signatures."""
        key = jwt.get_algorithm_by_name('RS256').prepare_key(self.public)
        jwk = jwt.algorithms.RSAAlgorithm.to_jwk(key, as_dict=True)
        return jwk | {'kid': self.kid, 'alg': 'RS256', 'use': 'sig'}

    def id_token(self, asked):
        """Return the signed claims about the person who follows the link."""
        now = int(time.time())
        claims = {
            'iss': self.address,
            'aud': CLIENT,
            'exp': now + 60,
            'iat': now,
            'nonce': asked['nonce'],
            f'{CLAIM}version': '1.3.0',
            f'{CLAIM}message_type': 'LtiResourceLinkRequest',
            f'{CLAIM}deployment_id': '1',
            f'{CLAIM}target_link_uri': f'{self.tool}/hub/',
            f'{CLAIM}resource_link': {'id': '7'},
            f'{CLAIM}context': {'id': COURSE, 'label': 'robots'},
            **self.people[asked['login_hint']],
            **self.changed,
        }
        claims = {name: value for name, value in claims.items() if value is not None}
        return jwt.encode(claims, self.key, self.algorithm, headers={'kid': self.kid})

    def settings(self, **others):
        """Return the table [lti] of a hub that trusts this platform."""
        return {
            'issuer': self.address,
            'client_id': CLIENT,
            'authorize_url': f'{self.address}/auth',
            'jwks_endpoint': f'{self.address}/jwks',
            'context_id': COURSE,
            **others,
        }


def person(username, *roles, user_id='4711', **others):
    """Return the platform's claims about a person with this user name."""
    return {
        'sub': user_id,
        f'{CLAIM}roles': [ROLE + role for role in roles or ['Learner']],
        f'{CLAIM}custom': {'username': username},
        **others,
    }


class Browser:
    """Follows an LTI launch with cookies, one step at a time."""

    def __init__(self, platform):
        self.platform = platform
        self.session = requests.Session()

    def follow_link(self, who, method='POST', **others):
        """Follow the link on the platform; return the form that the browser then has to send."""
        asked = {
            'iss': self.platform.address,
            'client_id': CLIENT,
            'login_hint': who,
            'lti_message_hint': 'link 7',
            'target_link_uri': f'{self.platform.tool}/hub/',
            **others,
        }
        there = f'{self.platform.tool}/hub/lti13/oauth_login'
        named = {'data' if method == 'POST' else 'params': asked}
        sent = self.session.request(method, there, allow_redirects=False, **named)
        assert sent.status_code == 302, sent.text
        address = sent.headers['Location']
        assert address.startswith(f'{self.platform.address}/auth?'), address
        answer = self.session.get(address)
        assert answer.status_code == 200, answer.text
        return {
            name: html.unescape(value)
            for name, value in FIELD.findall(answer.text)
            if name in {'id_token', 'state'}
        }

    def send(self, form):
        """Send the form to the tool; return its response, which may be a redirect."""
        there = f'{self.platform.tool}/hub/lti13/oauth_callback'
        return self.session.post(there, data=form, allow_redirects=False)

    def log_in(self, who, **others):
        """Follow the link, and send the form."""
        return self.send(self.follow_link(who, **others))

    def user(self):
        """Return the user whom the hub has logged in in this browser, or ''."""
        page = self.session.get(f'{self.platform.tool}/hub/home')
        if urlsplit(page.url).path != '/hub/home':
            assert parse_qs(urlsplit(page.url).query)['next'] == ['/hub/home'], page.url
            return ''
        return re.search(r'^\s*user: "(\w+)",$', page.text, re.MULTILINE)[1]
