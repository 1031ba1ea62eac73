"""Unusual answers, right and wrong: read tests/answers/, and make submissions from it.

Each file there has the answers to one exercise. Lines at its top name the lesson and the checks
with their points. An answer begins with `right NAME: why` or `wrong NAME: why`. A wrong one says
what it `earns`, a number for each check, and, with `says`, a word that the reason for each lost
point contains. Then come its changes to the first answer: lines that it removes (-) and adds (+),
and sometimes an unchanged line (a space) for the position. An answer with + lines only is
complete. `cell ID` has what else the student wrote into that cell, `cell +ID` into a new cell
after it.
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
    """A student's answer in one answer cell, and what is expected of its grading."""

    lesson: str
    exercise: str
    name: str
    why: str
    code: str
    full: dict[str, float]
    """The points of each check."""
    points: dict[str, float]
    """The points that the answer earns, by check."""
    says: str = ''
    """What the reason for each lost point has to contain."""
    cells: dict[str, str] = field(default_factory=dict)
    """What else the student wrote: by cell id, with '+' before it for a new cell after it."""

    @property
    def id(self) -> str:
        """A unique name of this answer."""
        return f'{self.exercise}-{self.name}'

    def lost(self, check: str) -> bool:
        """Whether it loses points in this check."""
        return self.points[check] < self.full[check]


@cache
def answers_to(exercise: str) -> list[Answer]:
    """Read the answers to one exercise. Raises ValueError with the answer if one is malformed."""
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
    """Read the answers to all exercises."""
    return [each for path in sorted(FOLDER.glob('*.txt')) for each in answers_to(path.stem)]


def in_class(answers: list[Answer]) -> list[list[Answer]]:
    """Combine answers to different exercises of a lesson into one notebook each, if possible.

    An answer with cells of its own gets a separate notebook: the cells could help another answer.
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
    """Return the released lesson with these answers, and the solutions' answers elsewhere."""
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
    """Return the lines of an answer. Raises ValueError if a line to change is not there."""
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
