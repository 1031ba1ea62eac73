"""The course's own words in outputs, in the language of the page: grading runs them in English."""

from copy import deepcopy
from functools import cache

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.picture_words import translate_alt_text
from my_robot_basics.language.speaking import LOCALE, in_language
from my_robot_basics.session.errors import in_lines
from nbformat import NotebookNode

from grader.authoring.edition_outputs import PANEL, PICTURE, OutputWords

MOST_CHARACTERS = 5_000
"""Longer outputs are not translated: only a student's own code prints so much."""


def in_page_language(output: NotebookNode, language: str) -> NotebookNode:
    """Return an output of a graded notebook with the course's words in a language."""
    kind = 'text' if output.output_type == 'stream' else 'data'
    if language == ENGLISH or (output.output_type != 'error' and kind not in output):
        return output
    shown = deepcopy(output)
    if output.output_type == 'error':
        shown.traceback = _of_error(output, language)
    elif kind == 'text':
        shown.text = _printed(output.text, language)
    elif output.output_type == 'display_data':
        plain, page = (str(output.data.get(f'text/{each}', '')) for each in ('plain', 'html'))
        shown.data['text/plain'] = _displayed(plain, page, language)
    return shown


def _of_error(output: NotebookNode, language: str) -> list[str]:
    """Return an error's lines; if it is a sentence of the course, translated."""
    said = f'{output.ename}: {output.evalue}'
    lines = [str(line) for line in output.traceback]
    if len(said) > MOST_CHARACTERS or ' '.join(lines).split() != said.split():
        return lines
    return in_lines(in_language(language, said))


def _displayed(plain: str, page: str, language: str) -> str:
    if len(plain) > MOST_CHARACTERS:
        return plain
    if page.startswith(PICTURE):
        shown = translate_alt_text(language, plain, LOCALE)
        return in_language(language, plain) if shown == plain else shown
    if page.startswith(PANEL):
        return _words(language).panel(plain)
    return _printed(plain, language)


def _printed(text: str, language: str) -> str:
    return text if len(text) > MOST_CHARACTERS else _words(language).printed(text)


@cache
def _words(language: str) -> OutputWords:
    return OutputWords(LOCALE, language)
