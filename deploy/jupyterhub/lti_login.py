"""Login from a learning platform: the library verifies claims, lti_users maps them to users."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from lti_users import LoginRefused, LtiLogin
from ltiauthenticator.lti13.auth import LTI13Authenticator
from ltiauthenticator.lti13.handlers import LTI13CallbackHandler
from tornado.web import HTTPError
from traitlets import Instance

AT_ONCE = 4
"""How many logins fetch the platform's keys at a time."""
_threads = ThreadPoolExecutor(AT_ONCE, 'lti')


class CallbackHandler(LTI13CallbackHandler):
    """Verifies a token in a thread: anybody can send one, and the platform may take 30 s."""

    async def post(self) -> None:
        """Log a person in, and let the hub answer others while the platform is asked for keys."""
        loop = asyncio.get_running_loop()
        verified = loop.run_in_executor(_threads, super().decode_and_validate_launch_request)
        await asyncio.wait([verified])
        self.decode_and_validate_launch_request = verified.result
        await super().post()


class PlatformAuthenticator(LTI13Authenticator):
    """Lets users of this machine in if the platform sends them."""

    callback_handler = CallbackHandler
    login = Instance(LtiLogin, help='The table [lti] of class.toml.').tag(config=True)
    # without the platform nobody can log in; the default page has a button that leads to an error
    custom_html = '<h1>Follow the link to this hub in your course on the learning platform.</h1>'

    async def authenticate(self, handler: Any, data: dict[str, Any] | None = None) -> str:
        """Return the user's name from verified claims. Raises HTTPError 403."""
        try:
            return self.login.user_of(data or {})
        except LoginRefused as refusal:
            raise HTTPError(403, str(refusal)) from None
