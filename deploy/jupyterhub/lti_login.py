"""Login from a learning platform: the library checks what it signed, lti_users whom that means."""

from typing import Any

from lti_users import LoginRefused, LtiLogin
from ltiauthenticator.lti13.auth import LTI13Authenticator
from tornado.web import HTTPError
from traitlets import Instance


class PlatformAuthenticator(LTI13Authenticator):
    """Lets in users of this machine whom the platform names."""

    login = Instance(LtiLogin, help='The table [lti] of class.toml.').tag(config=True)
    # there is no way in from here: the login page would have a button that leads to an error
    custom_html = '<h1>Follow the link to this hub in your course on the learning platform.</h1>'

    async def authenticate(self, handler: Any, data: dict[str, Any] | None = None) -> str:
        """Return the user's name, from claims that are checked. Raises HTTPError 403."""
        try:
            return self.login.user_of(data or {})
        except LoginRefused as refusal:
            raise HTTPError(403, str(refusal)) from None
