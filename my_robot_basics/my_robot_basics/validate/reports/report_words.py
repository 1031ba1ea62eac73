"""Texts of JupyterLab's button and dialog, and of a terminal, around a report."""

from my_robot_basics.language.speaking import in_language

TO_SHOW: tuple[str, ...] = (
    'Validation Results',
    'Close',
    'Show the check',
    'checked only at grading',
)
TO_SHOW += ('Run the visible checks of this lesson', 'passed', 'failed', 'partial')
TO_SHOW += ('Validate could not run: {why}', 'the server answered {status}')
TO_SHOW += ('a person reads it', 'could not be checked', 'more checks at grading')
TO_SHOW += ('{number} point', '{number} points', '{earned} of {points}', '{score}, {more}')
TO_SHOW += ('({points}; {more})', '({points})')


def front_end_texts(language: str) -> dict[str, str]:
    """Return the translation of each of these English texts."""
    return {text: in_language(language, text) for text in TO_SHOW}
