"""What is logged, in lines that move no cursor: file names and messages may be a student's."""

import logging

from grader.common.text import visible


class VisibleFilter(logging.Filter):
    """Spell out escapes, controls and marks of direction; the lines of a traceback stay."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Change a record; it is logged in any case."""
        record.msg, record.args = visible(record.getMessage()), None
        if record.exc_info:
            record.exc_text = visible(logging.Formatter().formatException(record.exc_info))
        return True


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
