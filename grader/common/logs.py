"""Log without control characters: file names and messages may come from a student."""

import logging
import re

from grader.common.text import visible

_PASSWORD = re.compile(r'(\bpostgres\S*?://[^\s/:@]*:)\S*@')


class VisibleFilter(logging.Filter):
    """Escape control characters and marks of text direction, except the line ends of a traceback.

    The password in a database's URL is removed.
    """

    def filter(self, record: logging.LogRecord) -> bool:
        """Change a record; it is always logged."""
        record.msg, record.args = _without_password(record.getMessage()), None
        if record.exc_info:
            record.exc_text = _without_password(
                logging.Formatter().formatException(record.exc_info)
            )
        return True


def _without_password(text: str) -> str:
    """Return a text to log: nbgrader's `db upgrade` logs the URL with its password."""
    return visible(_PASSWORD.sub(r'\1***@', text))


NBGRADER_LOGGING = {
    'filters': {'visible': {'()': 'grader.common.logs.VisibleFilter'}},
    'handlers': {'console': {'filters': ['visible']}},
}
"""The value of nbgrader's setting `logging_config`, for the same filter in its commands."""


def log_visibly() -> None:
    """Log to stderr through the filter, unless logging was configured before."""
    handler = logging.StreamHandler()
    handler.addFilter(VisibleFilter())
    logging.basicConfig(handlers=[handler])


def print_at_once(line: str) -> None:
    """Print a line at once, into a pipe too: it says what the program waits for."""
    print(line, flush=True)
