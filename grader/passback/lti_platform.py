"""A learning platform's Assignment and Grade Services, through pylti1p3."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import requests
from cryptography.hazmat.primitives import serialization
from pylti1p3.assignments_grades import AssignmentsGradesService
from pylti1p3.exception import LtiException, LtiServiceException
from pylti1p3.grade import Grade
from pylti1p3.lineitem import LineItem
from pylti1p3.registration import Registration
from pylti1p3.service_connector import ServiceConnector

from grader.common.errors import CourseError
from grader.passback.lti_queue import Score
from grader.passback.lti_settings import LtiSettings

AGS = 'https://purl.imsglobal.org/spec/lti-ags/scope'
SCOPES = [f'{AGS}/lineitem', f'{AGS}/score']
TIMEOUT = (10.0, 30.0)
"""Seconds to connect, and between two bytes of an answer."""
EARLY = 30.0
"""Seconds before its expiry from which a token is no longer used."""
CONFLICT = 409
UNAUTHORISED = (401, 403)
LATER = (408, 425, 429)
"""Status codes after which to try again later, as after any from 500 on."""


class PlatformIsAway(Exception):
    """The platform does not answer, or not validly: nothing can be sent for now."""


class ScoreRefused(Exception):
    """The platform has answered, and does not take this score."""

    def __init__(self, why: str, status: int) -> None:
        super().__init__(why)
        self.status = status


@dataclass
class _Connector(ServiceConnector):
    """Keeps a token while it is valid; its requests have a time limit."""

    registration: Registration
    tokens: dict[str, tuple[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        session = _Session()
        super().__init__(self.registration, session)

    def _get_cached_access_token(self, scope_key: str) -> str | None:
        token, until = self.tokens.get(scope_key, ('', 0.0))
        return token if time.monotonic() < until else None

    def _cache_access_token(self, scope_key: str, access_token: str, expires_in: float) -> None:
        self.tokens[scope_key] = access_token, time.monotonic() + float(expires_in) - EARLY


class _Session(requests.Session):
    """Sends requests with a time limit, and does not follow redirects."""

    def request(self, *arguments: Any, **options: Any) -> requests.Response:
        return super().request(
            *arguments, **{'timeout': TIMEOUT, **options, 'allow_redirects': False}
        )


class LtiService:
    """Sends scores to the platform. Each call may raise PlatformIsAway or ScoreRefused."""

    def __init__(self, settings: LtiSettings) -> None:
        """Prepare requests; nothing is sent yet. Raises CourseError if the key is damaged."""
        registration = Registration()
        registration.set_issuer(settings.issuer).set_client_id(settings.client_id)
        registration.set_auth_token_url(settings.token_url)
        registration.set_tool_private_key(settings.key)
        registration.set_tool_public_key(public_key(settings.key))
        if settings.audience:
            registration.set_auth_audience(settings.audience)
        data = {'scope': SCOPES, 'lineitems': settings.lineitems}
        self._connector = _Connector(registration)
        self._service = AssignmentsGradesService(self._connector, data)  # type: ignore[arg-type]
        self._columns: dict[str, LineItem] = {}

    def send(self, score: Score) -> None:
        """Send a score to the platform; create the assignment's column if there is none."""
        changed = datetime.fromtimestamp(score.changed, UTC).isoformat(timespec='milliseconds')
        grade = Grade().set_user_id(score.user_id).set_timestamp(changed)
        grade.set_score_given(max(score.score, 0.0)).set_score_maximum(score.max_score)
        grade.set_activity_progress('Completed').set_grading_progress('FullyGraded')
        try:
            self._service.put_grade(grade, self._column_of(score))
        except LtiServiceException as error:
            raise self._problem(error) from None
        except (requests.RequestException, LtiException) as error:
            raise PlatformIsAway(_in_a_line(error)) from None
        except (ValueError, TypeError, LookupError, AttributeError) as error:
            # the library does not check the form of answers
            raise PlatformIsAway(
                f'an answer that is not in the format of LTI ({_in_a_line(error)})'
            ) from None

    def _column_of(self, score: Score) -> LineItem:
        name = score.assignment
        if name not in self._columns:
            wanted = LineItem().set_tag(name).set_label(name)
            wanted.set_score_maximum(score.max_score).set_resource_id(name)
            self._columns[name] = self._service.find_or_create_lineitem(wanted)
        return self._columns[name]

    def _problem(self, error: LtiServiceException) -> Exception:
        status = error.response.status_code
        said = ' '.join(error.response.text.split())[:200]
        what = f'it answered {status}' + (f': {said}' if said else '')
        if status in UNAUTHORISED:
            self._connector.tokens.clear()
            return PlatformIsAway(
                f'{what} (check client_id and key_file, and whether the platform lets this tool '
                'write scores)'
            )
        if status >= 500 or status in LATER or 300 <= status < 400:
            return PlatformIsAway(what)
        return ScoreRefused(what, status)


def public_key(private_key: str) -> str:
    """Return the public part of a key, in PEM. Raises CourseError if the key is damaged."""
    try:
        key = serialization.load_pem_private_key(private_key.encode(), password=None)
    except (ValueError, TypeError) as error:  # TypeError if the key has a password
        raise CourseError(f'the key of lti.toml is damaged: {_in_a_line(error)}') from None
    form = serialization.PublicFormat.SubjectPublicKeyInfo
    return key.public_key().public_bytes(serialization.Encoding.PEM, form).decode()


def public_jwk(private_key: str) -> Mapping[str, Any]:
    """Return the public part of a key as JWK, for platforms that require this form."""
    return Registration.get_jwk(public_key(private_key))


def _in_a_line(error: Exception) -> str:
    return ' '.join(f'{type(error).__name__}: {error}'.split())[:300]
