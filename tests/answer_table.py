"""Unusual answers, right and wrong: what is in tests/answers/, and as a student hands it in.

Each file there holds the answers to one exercise. Lines at its top name the lesson and the
checks, with their points. An answer begins with `right NAME: why` or `wrong NAME: why`; a wrong
one says what it `earns`, a number for each check, and a word that the reason for each lost point
`says`. Then comes what it changes in the first answer: the lines that it takes out (-) and puts
in (+), and here and there a line that stays (a space) to tell where. An answer of + lines alone
stands for itself. `cell ID` tells what else the student wrote there, `cell +ID` in a new cell
behind it.
"""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from answered import read
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell

FOLDER = Path(__file__).parent / 'answers'


@dataclass(frozen=True)
class Answer:
    """What one student writes into one answer cell, and what comes of it."""

    lesson: str
    exercise: str
    name: str
    why: str
    code: str
    full: dict[str, float]
    """What can be earned, by the check."""
    points: dict[str, float]
    """What it earns."""
    says: str = ''
    """What the reason for each lost point has to hold."""
    cells: dict[str, str] = field(default_factory=dict)
    """What else the student wrote: by the cell's id, '+' before it for a new cell behind it."""

    @property
    def id(self) -> str:
        """A name that no other answer has."""
        return f'{self.exercise}-{self.name}'

    def lost(self, check: str) -> bool:
        """Whether it loses points at this check."""
        return self.points[check] < self.full[check]


@cache
def answers_to(exercise: str) -> list[Answer]:
    """Read the answers to one exercise. Raises ValueError, with the answer, where one is wrong."""
    path = FOLDER / f'{exercise}.txt'
    head, *blocks = path.read_text(encoding='utf-8').split('\n\n')
    told = [line.split() for line in head.splitlines() if not line.startswith('#')]
    lesson = told[0][1]
    full = {check: float(points) for _, check, points in told[1:]}
    found: list[Answer] = []
    for block in blocks:
        usual = found[0].code.splitlines() if found else []
        try:
            found.append(_answer(block.splitlines(), lesson, exercise, full, usual))
        except ValueError as error:
            title = block.partition('\n')[0]
            raise ValueError(f'{path.name}: the answer {title!r}: {error}') from error
    return found


def all_answers() -> list[Answer]:
    """Read all of them."""
    return [each for path in sorted(FOLDER.glob('*.txt')) for each in answers_to(path.stem)]


def in_class(answers: list[Answer]) -> list[list[Answer]]:
    """Put answers to the exercises of one lesson into one notebook each, where that is possible.

    An answer with cells of its own gets a notebook alone: those could help another one.
    """
    alone = [[each] for each in answers if each.cells]
    papers: dict[tuple[str, int], list[Answer]] = {}
    met: dict[str, int] = {}
    for each in answers:
        if not each.cells:
            met[each.exercise] = place = met.get(each.exercise, -1) + 1
            papers.setdefault((each.lesson, place), []).append(each)
    return [*papers.values(), *alone]


def paper(answers: list[Answer]) -> NotebookNode:
    """Return the released lesson with these answers, and the solutions' for the others."""
    lesson = answers[0].lesson
    notebook = read('notebooks', lesson)
    wanted = {cell.id: cell.source for cell in read('solutions', lesson).cells}
    wanted |= {each.exercise: each.code for each in answers}
    others = {cell: text for each in answers for cell, text in each.cells.items()}
    cells = []
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('solution'):
            cell.source = wanted[cell.id]
        cell.source = others.pop(cell.id, cell.source)
        cells.append(cell)
        if behind := others.pop(f'+{cell.id}', ''):
            cells.append(new_code_cell(behind))
    if others:
        raise ValueError(f'{lesson} has no cells {", ".join(others)}')
    notebook.cells = cells
    return notebook


def _answer(
    lines: list[str], lesson: str, exercise: str, full: dict[str, float], usual: list[str]
) -> Answer:
    kind, title = lines[0].split(' ', maxsplit=1)
    name, why = title.split(': ', maxsplit=1)
    points, says, code, cells = dict(full), '', [], {}
    part = code
    for line in lines[1:]:
        word, _, rest = line.partition(' ')
        if word == 'earns':
            points = dict(zip(full, map(float, rest.split()), strict=True))
        elif word == 'says':
            says = rest
        elif word == 'cell':
            part = cells[rest] = []
        elif line[0] in '+- ':
            part.append(line)
        else:
            raise ValueError(f'{line!r} begins with none of earns, says, cell, +, - and a space')
    if (kind == 'right') != (points == full):
        raise ValueError(f'it is {kind}, and earns {points} of {full}')
    written = {cell: '\n'.join(line[1:] for line in text) for cell, text in cells.items()}
    changed = '\n'.join(_changed(usual, code))
    return Answer(lesson, exercise, name, why, changed, full, points, says, written)


def _changed(usual: list[str], changes: list[str]) -> list[str]:
    """Return the lines of an answer. Raises ValueError where one to change is not there."""
    if changes and all(line[0] == '+' for line in changes):
        return [line[1:] for line in changes]
    result, done = [], 0
    for line in changes:
        mark, text = line[0], line[1:]
        if mark == '+':
            result.append(text)
            continue
        if text not in usual[done:]:
            raise ValueError(f'{text!r} is no line of the first answer, or stands further up')
        here = usual.index(text, done)
        result += usual[done:here] + [text] * (mark == ' ')
        done = here + 1
    return result + usual[done:]
