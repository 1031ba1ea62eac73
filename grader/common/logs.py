"""What is logged, in lines that move no cursor: file names and messages may be a student's."""

import logging
import re

from grader.common.text import visible

_PASSWORD = re.compile(r'(\bpostgres\S*?://[^\s/:@]*:)\S*@')


class VisibleFilter(logging.Filter):
    """Spell out escapes, controls and marks of direction; the lines of a traceback stay.

    The password in the address of a database is taken out.
    """

    def filter(self, record: logging.LogRecord) -> bool:
        """Change a record; it is logged in any case."""
        record.msg, record.args = _told(record.getMessage()), None
        if record.exc_info:
            record.exc_text = _told(logging.Formatter().formatException(record.exc_info))
        return True


def _told(text: str) -> str:
    """Return a text to log: nbgrader's `db upgrade` logs an address with its password."""
    return visible(_PASSWORD.sub(r'\1***@', text))


NBGRADER_LOGGING = {
    'filters': {'visible': {'()': 'grader.common.logs.VisibleFilter'}},
    'handlers': {'console': {'filters': ['visible']}},
}
"""nbgrader's setting `logging_config` for the same in its own commands."""


def log_visibly() -> None:
    """Log to stderr, unless something else was set up."""
    handler = logging.StreamHandler()
    handler.addFilter(VisibleFilter())
    logging.basicConfig(handlers=[handler])


def tell(line: str) -> None:
    """Print a line at once, into a pipe too: anyone who waits has to know what for."""
    print(line, flush=True)
