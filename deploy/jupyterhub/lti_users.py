"""Map a person of a learning platform to a user of this machine: the table [lti] of class.toml.

The platform is trusted, and signs what it says about a person. What people wrote about themselves
there is not trusted: docs/lti.md says which claims that concerns.
"""

import grp
import os
import pwd
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

CLAIM = 'https://purl.imsglobal.org/spec/lti/claim/'
INSTRUCTOR = 'http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor'
CUSTOM = 'custom_'
"""Prefix of a parameter that the platform was told to send, as in the library."""
TEXTS = ('issuer', 'authorize_url', 'jwks_endpoint')
OTHERS = ('client_id', 'username_claim', 'email_domain', 'context_id', 'user_ids')
SELF_CHOSEN = (
    'name',
    'given_name',
    'middle_name',
    'family_name',
    'nickname',
    'preferred_username',
)
LOCAL = ('localhost', '127.0.0.1', '::1')
LONGEST = 100
"""How many characters of a received value a refusal repeats."""


class LoginRefused(Exception):
    """The person whom the platform sent has no account here; the text says what to do."""


@dataclass(frozen=True)
class LtiLogin:
    """The table [lti], and the users whom it may let in."""

    issuer: str
    authorize_url: str
    jwks_endpoint: str
    client_id: frozenset[str]
    students: str
    """The group of users who may log in."""
    instructor: str
    username_claim: str = f'{CUSTOM}username'
    email_domain: str = ''
    """If the claim is an e-mail address: the only domain whose addresses name users."""
    context_id: str = ''
    """The platform's id of the course, if no other course may send users."""
    user_ids: Mapping[str, str] = field(default_factory=dict)
    """The platform's id (sub) of each user; if set, no other claim is used."""

    def user_of(self, claims: Mapping[str, Any]) -> str:
        """Return the user whom verified claims name. Raises LoginRefused."""
        context = _inner(claims, 'context').get('id')
        if self.context_id and context != self.context_id:
            raise LoginRefused(
                f'The platform sent you from its course {_shown(context)}, and this hub is for '
                f'{self.context_id!r}: follow the link there. (context_id in class.toml)'
            )
        name, received = self._by_id(claims) if self.user_ids else self._by_claim(claims)
        if name == self.instructor:
            roles = claims.get(f'{CLAIM}roles')
            if isinstance(roles, list) and INSTRUCTOR in roles:
                return name
            raise LoginRefused(
                f'The platform sent {received}, which is the instructor, and did not say that '
                'you teach this course: tell the instructor, whose role there is Instructor.'
            )
        # JupyterHub would turn Ada into ada, who may be another person
        if name != name.lower() or not is_member(name, self.students):
            raise LoginRefused(
                f'The platform sent {received}, and no user of this machine in the group '
                f'{self.students!r} has that name: ask the instructor to add one.'
            )
        return name

    def _by_id(self, claims: Mapping[str, Any]) -> tuple[str, str]:
        received = f'sub = {_shown(claims.get("sub"))}'
        for name, user_id in self.user_ids.items():
            if user_id == claims.get('sub'):
                return name, received
        raise LoginRefused(
            f'The platform sent {received}, which is nobody in [lti.user_ids] of class.toml: ask '
            'the instructor to add you there.'
        )

    def _by_claim(self, claims: Mapping[str, Any]) -> tuple[str, str]:
        claim = self.username_claim
        custom = claim.startswith(CUSTOM)
        found = _inner(claims, 'custom') if custom else claims
        value = found.get(claim.removeprefix(CUSTOM) if custom else claim)
        received = f'{claim} = {_shown(value)}'
        if not isinstance(value, str) or not value:
            # the library would use sub instead, which has other names
            raise LoginRefused(
                f'The platform sent {received}, expected your name: ask the instructor to let the '
                'platform send that claim, as docs/lti.md says.'
            )
        if not self.email_domain:
            return value, received
        name, _, domain = value.lower().rpartition('@')
        if domain != self.email_domain.lower():
            raise LoginRefused(
                f'The platform sent {received}, and only addresses of {self.email_domain} name '
                'users here: give the platform that address of yours, or ask the instructor.'
            )
        return name, received


def read_login(settings: Mapping[str, Any]) -> LtiLogin:
    """Return the table [lti] of class.toml. Raises ValueError if something in it is wrong."""
    table = dict(settings['lti'])
    if problem := _problem_in(table):
        raise ValueError(f'class.toml, [lti]: {problem} (docs/lti.md shows one that is right)')
    ids = table.pop('client_id')
    table['client_id'] = frozenset([ids] if isinstance(ids, str) else ids)
    return LtiLogin(**table, students=settings['students'], instructor=settings['instructor'])


def is_member(name: str, group: str) -> bool:
    """Whether this machine has such a user, and the user is in the group."""
    try:
        return grp.getgrnam(group).gr_gid in os.getgrouplist(name, pwd.getpwnam(name).pw_gid)
    except (KeyError, ValueError):  # ValueError: a name with a null byte
        return False


def _problem_in(table: dict[str, Any]) -> str:
    if unknown := sorted(table.keys() - {*TEXTS, *OTHERS}):
        return f'{unknown[0]!r} is not known'
    optional = [name for name in OTHERS[1:-1] if name in table]
    for name in (*TEXTS, *optional):
        if not isinstance(table.get(name), str) or not table[name]:
            return f'{name} is missing, or is not a text in quotes'
    ids = table.get('client_id')
    ids = [ids] if isinstance(ids, str) else ids
    if not isinstance(ids, list) or not all(isinstance(each, str) and each for each in ids or [0]):
        return 'client_id is missing, or is neither a text nor a list of them'
    for name in TEXTS[1:]:
        address = urlsplit(table[name])
        if address.scheme != 'https' and address.hostname not in LOCAL:
            return f'{name} does not begin with https://: anyone on the way could be anybody here'
    if table.get('username_claim') in SELF_CHOSEN:
        return f'{table["username_claim"]} is what people call themselves, and so could be anybody'
    if table.get('username_claim') == 'email' and 'email_domain' not in table:
        return 'email needs an email_domain: ada@ANYWHERE would be ada'
    user_ids = table.get('user_ids', {})
    if 'user_ids' in table and 'username_claim' in table:
        return 'either [lti.user_ids] names users, or username_claim does'
    texts = isinstance(user_ids, dict) and all(isinstance(id_, str) for id_ in user_ids.values())
    if not texts or ('user_ids' in table and not user_ids):
        return '[lti.user_ids] is empty, or has an id that is no text: write ada = "4711"'
    if len({*user_ids.values()}) < len(user_ids):
        return '[lti.user_ids] gives two users the same id'
    return ''


def _inner(claims: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    inner = claims.get(CLAIM + name)
    return inner if isinstance(inner, dict) else {}


def _shown(value: object) -> str:
    if value is None:
        return 'nothing'
    text = ascii(value)
    return text if len(text) <= LONGEST else f'{text[:LONGEST]}…'
