"""Translate the course's own words in the outputs that a lesson shows before it is run.

The outputs are those of the English release. If a cell of an edition is run again, displays,
sentences and descriptions of pictures by the course are in its language; what the lesson's code
or `ros2` prints is in English.
"""

import html
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from my_robot_basics.language.catalogues import read_translations
from my_robot_basics.language.english import PHRASE, letters_left
from my_robot_basics.language.picture_words import join_alt_text_lines, translate_alt_text
from my_robot_basics.language.sentences import Sentences
from my_robot_basics.language.templates import LETTERS, Template
from nbformat import NotebookNode

PANEL, DOCTOR = '<pre style="margin:0;padding-left:8px;', '<div style="font-size:13px;line-height'
"""How the HTML of a node's panel and of the topic doctor's findings begins."""
PICTURE = '<img alt="'
"""How the HTML of a picture begins."""
PARTS = ('live', 'doctor', 'checks')
"""The catalogues of texts that a cell may print."""
COLON = '{one}: {other}'
"""A sentence that ends with a colon, before a line of code."""
BEGINS = 4
"""Letters before the first placeholder: with fewer, any text could match the sentence."""

_TEXT = re.compile(r'(<pre.*?</pre>)|(?<=>)([^<>]*[^\W\d_][^<>]*)', re.DOTALL)
"""Code in a page, which is not translated; or a text between two tags."""
_GOES_ON = re.compile(r'(?<=^  )(\w+ goes on|(\S+, )?line \d+, in \S+: .*)$')
"""What follows an exception in a panel: where it was raised, and that the node goes on."""
_OF_A_COMMAND = re.compile(r'^\w+: started$', re.MULTILINE)
"""What `run_commands` prints of a command. A student's code may print the same."""
_COLUMNS = re.compile(r'(.*\s{2})(\S.*)|(\w[\w ]*: )(.+)')
"""A line with a sentence in its second column, or after a prefix of the lesson's code."""


@dataclass(frozen=True)
class OutputWords:
    """Translates the course's own words in outputs, for one language."""

    locale: Path
    language: str

    def translate(self, output: NotebookNode) -> None:
        """Translate an output's words, if they are the course's, in place."""
        if output.output_type == 'stream':
            said = _OF_A_COMMAND.sub(lambda found: self._say(found[0]), output.text)
            output.text = self.printed(said)
        data = output.get('data', {})
        page = data.get('text/html', '')
        if output.output_type != 'display_data':
            return
        if page.startswith(PICTURE):
            self._picture(output)
        elif page.startswith(DOCTOR):
            data['text/html'] = _TEXT.sub(
                lambda found: found[1] or self._translate_html(found[2]), page
            )
        elif page.startswith(PANEL):
            data['text/plain'] = self.panel(data['text/plain'])
            tag, end, _ = page.partition('>')
            data['text/html'] = f'{tag}{end}{html.escape(data["text/plain"])}</pre>'
        elif not page and 'text/plain' in data:
            data['text/plain'] = self.printed(data['text/plain'])

    @cached_property
    def _sentences(self) -> Sentences:
        known: dict[str, str] = {}
        for part in PARTS:
            known |= read_translations(self.locale, self.language, part)
        return Sentences(known)

    @cached_property
    def _begin(self) -> list[Template]:
        """The sentences with placeholders that begin with words."""
        known: Mapping[str, str] = self._sentences.translations
        made = (Template.of(english, translation) for english, translation in known.items())
        return [t for t in made if t.places and len(LETTERS.findall(t.literals[0])) >= BEGINS]

    def _say(self, text: str) -> str:
        return self._sentences.translate(text)

    def _translate_html(self, text: str) -> str:
        """Translate a text in the topic doctor's HTML."""
        said = html.unescape(text.strip())
        shown = self._say(said.removesuffix(':'))
        if said.endswith(':'):
            colon = self._sentences.translations.get(COLON, COLON)
            shown = colon.format(one=shown, other='').rstrip()
        return text.replace(text.strip(), html.escape(shown))

    def _picture(self, output: NotebookNode) -> None:
        """Translate a picture's alternative text in all places of the output."""
        data = output.data
        data['text/plain'] = translate_alt_text(self.language, data['text/plain'], self.locale)
        words = join_alt_text_lines(self.language, data['text/plain'], self.locale)
        _, quote, source = data['text/html'].removeprefix(PICTURE).partition('"')
        data['text/html'] = f'{PICTURE}{html.escape(words)}{quote}{source}'
        for about in output.metadata.values():
            if 'alt' in about:
                about['alt'] = words

    def panel(self, text: str) -> str:
        """Translate the state of a node, and what follows an exception, but not log lines."""
        first, *lines = text.split('\n')
        title, colon, state = first.partition(': ')
        lines = [_GOES_ON.sub(lambda found: self._say(found[0]), line) for line in lines]
        return '\n'.join([f'{title}{colon}{self._say(state)}', *lines])

    def printed(self, text: str) -> str:
        """Translate the printed lines that are the course's."""
        return _by_line(text, self._printed)

    def _printed(self, line: str) -> str:
        """Translate a printed line, or the part of it that is a sentence of the course."""
        if self._is_ours(line):
            return self._say(line)
        if columns := _COLUMNS.fullmatch(line):
            before, words, said, sentence = columns.groups()
            if words and self._is_ours(words):
                return before + self._say(words)
            if sentence and ' ' in sentence and sentence in self._sentences.translations:
                return said + self._say(sentence)
        return line

    def _is_ours(self, text: str) -> bool:
        """Whether it is a sentence of the course, or one with known words in its placeholders."""
        if text in self._sentences.translations:
            return ' ' in text
        return any(all(map(self._is_said, found.values())) for found in self._fits(text))

    def _fits(self, text: str) -> Iterator[dict[str, str]]:
        for template in self._begin:
            yield from template.fits(text)

    def _is_said(self, part: str) -> bool:
        return letters_left(part) < PHRASE or self._say(part) != part


def _by_line(text: str, translate: Callable[[str], str]) -> str:
    return ''.join(
        translate(line.rstrip('\r\n')) + line[len(line.rstrip('\r\n')) :]
        for line in text.splitlines(keepends=True)
    )
