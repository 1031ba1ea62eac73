"""Login from a learning platform: the library verifies claims, lti_users maps them to users."""

from typing import Any

from lti_users import LoginRefused, LtiLogin
from ltiauthenticator.lti13.auth import LTI13Authenticator
from tornado.web import HTTPError
from traitlets import Instance


class PlatformAuthenticator(LTI13Authenticator):
    """Lets users of this machine in if the platform sends them."""

    login = Instance(LtiLogin, help='The table [lti] of class.toml.').tag(config=True)
    # without the platform nobody can log in; the default page has a button that leads to an error
    custom_html = '<h1>Follow the link to this hub in your course on the learning platform.</h1>'

    async def authenticate(self, handler: Any, data: dict[str, Any] | None = None) -> str:
        """Return the user's name from verified claims. Raises HTTPError 403."""
        try:
            return self.login.user_of(data or {})
        except LoginRefused as refusal:
            raise HTTPError(403, str(refusal)) from None
