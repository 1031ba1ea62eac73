"""Parse a command line that starts one executable with `ros2 run`, without a shell."""

import itertools
import re
import shlex
from dataclasses import dataclass

OPTIONS_OF_RULES = '-r', '--remap'
OPTIONS_OF_PARAMETERS = '-p', '--param'
OPTIONS_OF_FILES = ('--params-file',)
_OF_A_SHELL = set('();<>|&')
"""A shell's operators, which separate commands; `shlex` returns them as separate words."""
_EXPANDED = '$`'
"""Characters with which a shell's expansions begin."""
_PLACE = re.compile(r'\{\w+\}')
"""A replacement field of an f-string: the text lacks its f."""
_WIDE = {'：': ':', '＝': '='}
"""Characters of a Chinese keyboard, which look like those of a rule or parameter."""
MOST_CHARACTERS = 2_000


class BadCommandLine(ValueError):
    """A text that is not such a command line: what was seen, and a hint."""

    def __init__(self, seen: str, hint: str) -> None:
        super().__init__(f'{seen}: {hint}')
        self.seen = seen
        self.hint = hint


@dataclass(frozen=True)
class CommandLine:
    """The words of `ros2 run PACKAGE EXECUTABLE --ros-args …`."""

    words: tuple[str, ...]

    def rules(self) -> list[tuple[str, str]]:
        """Return both sides of each remapping rule, in order: ('__ns', '/left')."""
        rules = [rule for _, rule in self.options(*OPTIONS_OF_RULES)]
        return [(left, right) for left, _, right in (rule.partition(':=') for rule in rules)]

    def options(self, *names: str) -> list[tuple[str, str]]:
        """Return each of these options with the word after it, in order."""
        return [pair for pair in itertools.pairwise(self.words) if pair[0] in names]

    def without_sign(self, *names: str) -> str:
        """Return the first word after one of these options that has no `:=`; '' if there is none.

        rcl refuses such a word, and the program ends at once.
        """
        words = (word for _, word in self.options(*names))
        return next((word for word in words if ':=' not in word), '')


def parse(text: str, *, package: str, executable: str) -> CommandLine:
    """Parse a command line that starts this executable and does nothing else.

    Syntax that needs a shell (a second command, `&`, a variable) is refused, and so are arguments
    before `--ros-args`. Raises BadCommandLine.
    """
    start = ['ros2', 'run', package, executable]
    text = text.strip().replace('\\\n', ' ')
    if len(text) > MOST_CHARACTERS:
        raise BadCommandLine(f'{len(text)} characters', 'write one command line')
    if found := _PLACE.findall(text):
        hint = 'put an f before the quotation mark: Python then puts the value there'
        raise BadCommandLine(f'{found[0]} itself', hint)
    if wide := [character for character in text if character in _WIDE]:
        strange, plain = wide[0], _WIDE[wide[0]]
        hint = f'write {plain!r} in its place, which is half as wide'
        raise BadCommandLine(f'a full-width {strange!r}', hint)
    if '\n' in text:
        raise BadCommandLine('several lines', 'write one line, or end each but the last with \\')
    if text.startswith('$ '):
        raise BadCommandLine('a $ in front', 'leave out the prompt of the terminal')
    if expanded := [character for character in text if character in _EXPANDED]:
        raise BadCommandLine(f'a {expanded[0]}', 'write what you mean in full: no shell reads it')
    words = _words(text)
    if found := [word for word in words if set(word) <= _OF_A_SHELL]:
        hint = 'write one command that starts one node: no shell reads it'
        raise BadCommandLine(f'the word {found[0] or repr("")}', hint)
    if any(word.startswith(':=') for word in words):
        raise BadCommandLine('a space before :=', 'write no spaces around it: name:=value')
    if words[:4] != start:
        hint = f'begin with {shlex.join(start)}'
        raise BadCommandLine(shlex.join(words[:4]) or 'nothing', hint)
    if words[4:5] != ['--ros-args']:
        hint = 'write --ros-args after the executable, and rules and parameters after that'
        before = words[4] if words[4:] else 'nothing'
        raise BadCommandLine(f'{before} where --ros-args belongs', hint)
    return CommandLine(tuple(words))


def _words(text: str) -> list[str]:
    lexer = shlex.shlex(text, posix=True, punctuation_chars=True)
    lexer.whitespace_split, lexer.commenters = True, ''
    try:
        return list(lexer)
    except ValueError as error:
        raise BadCommandLine(str(error).lower(), 'close each quotation mark') from None
