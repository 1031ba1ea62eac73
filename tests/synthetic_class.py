"""A class of any size, made of the sample answers: it is known what each notebook earns.

    .venv/bin/python tests/synthetic_class.py 500 class.zip

writes one as a course platform's download. Notebooks with the same answer differ only in what
must not matter: comments and prints after it, the student's own text and cells, and stored outputs
of cells.
"""

import random
import sys
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import cycle
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_output

if __name__ == '__main__':
    sys.path[:0] = [str(Path(__file__).parents[1])]

from package_changes import Files, write
from sample_class import EXPECTED, PATHS, assignment_of, package_of, rebased

from grader.course import Course
from grader.notebook.restore import grade_id, role
from grader.storage.records import records, verdicts

HONEST = 0.6
"""The share of a class that answers correctly."""
REMARKS = (
    'took me an hour',
    'see page 12 of my notes',
    'TODO: ask about this on Monday',
    'größer als gedacht',
    'works on my machine',
    'I checked this twice',
)


@dataclass(frozen=True)
class Paper:
    """A student's submission."""

    student_id: str
    assignment: str
    sample: str
    """The sample whose answers it has."""
    text: str
    """The content of the notebook's file."""

    @property
    def file_name(self) -> str:
        """Return its path in the archive: with a package, in a folder of the student's."""
        between = '/' if self.package else '_'
        return f'{self.student_id}{between}{self.assignment}.ipynb'

    @property
    def package(self) -> Files:
        """Return the files of the package beside the notebook."""
        return package_of(self.sample)

    @property
    def expected(self) -> dict[str, float | None]:
        """Return the score of each graded cell; None if it is graded by hand."""
        return {name: score for name, (score, *_) in EXPECTED[self.sample].items()}


def synthetic_class(
    size: int, *, assignments: Sequence[str] = (), samples: Sequence[str] = (), seed: int = 0
) -> list[Paper]:
    """Return the submissions of a class: one for each student, with the assignments in turn.

    Each sample is used once before one is used again. `assignments` and `samples` restrict the
    choice. The same arguments give the same class.
    """
    chance = random.Random(seed)
    chosen = samples or PATHS
    names = assignments or sorted({assignment_of(PATHS[name]) for name in chosen})
    decks = {name: _deck(name, chosen, chance) for name in names}
    return [
        _paper(f'student_{number:04}', next(decks[name]), chance)
        for number, name in zip(range(1, size + 1), cycle(names), strict=False)
    ]


def hand_in(course: Course, papers: Sequence[Paper]) -> None:
    """Put submissions into a course's submitted/."""
    for paper in papers:
        folder = course.folder('submitted', paper.student_id, paper.assignment)
        folder.mkdir(parents=True)
        (folder / f'{paper.assignment}.ipynb').write_text(paper.text, encoding='utf-8')
        write(paper.package, folder)


def zip_up(papers: Sequence[Paper], archive: Path) -> None:
    """Write submissions into one archive."""
    with zipfile.ZipFile(archive, 'w', zipfile.ZIP_DEFLATED) as file:
        for paper in papers:
            file.writestr(paper.file_name, paper.text)
            for name, text in paper.package.items():
                file.writestr(f'{paper.student_id}/arm_player/{name}', text)


def wrong_scores(course: Course, papers: Sequence[Paper]) -> list[str]:
    """Return a line for each score in the gradebook that is not the expected one."""
    whose = {(paper.student_id, paper.assignment) for paper in papers}
    found = {
        (record.student_id, record.assignment, record.grade_id): record.score
        for record in records(course, only=whose)
        if record.submitted
    }
    wanted = {
        (paper.student_id, paper.assignment, name): score
        for paper in papers
        for name, score in paper.expected.items()
    }
    samples = {(paper.student_id, paper.assignment): paper.sample for paper in papers}
    return [
        f'{" ".join(each)} ({samples[each[:2]]}): expected {wanted.get(each, "nothing")}, '
        f'the gradebook holds {found.get(each, "nothing")}{_comment(course, *each)}'
        for each in sorted(wanted.keys() | found.keys())
        if each not in found or each not in wanted or found[each] != wanted[each]
    ]


def _comment(course: Course, student_id: str, assignment: str, name: str) -> str:
    """Return the reason and notes of a cell's verdict, if any."""
    said = verdicts(course, student_id, assignment).get(name, {})
    told = [said.get('reason'), *said.get('notes', ())]
    return ''.join(f'; {" ".join(text.split())}' for text in told if text)


def _deck(assignment: str, chosen: Sequence[str], chance: random.Random) -> Iterator[str]:
    """Yield an assignment's samples without end; HONEST is the share of right ones."""
    ours = [name for name in chosen if assignment_of(PATHS[name]) == assignment]
    right = [name for name in ours if '-pass-' in name]
    wrong = [name for name in ours if '-pass-' not in name]
    piles = [cycle(chance.sample(pile, len(pile))) for pile in (right, wrong) if pile]
    while True:
        yield next(piles[0] if chance.random() < HONEST else piles[-1])


def _paper(student_id: str, sample: str, chance: random.Random) -> Paper:
    return Paper(student_id, assignment_of(PATHS[sample]), sample, _varied(sample, chance))


def _varied(sample: str, chance: random.Random) -> str:
    """Return a sample with variations that must not matter."""
    text, untouched = _kept(sample)
    if sample.endswith('-not_json'):
        return text
    notebook = nbformat.reads(text, as_version=4)
    answers = [] if '-zero-' in sample else [c for c in notebook.cells if role(c) == 'answer']
    for cell in notebook.cells:
        if cell.cell_type == 'code':
            if cell in answers and cell.source not in untouched:
                cell.source = f'{cell.source.rstrip()}\n{_lines(chance)}'
            cell.execution_count = chance.randrange(1, 90)
            if chance.random() < 0.5:
                cell.outputs = [new_output('stream', text=f'{chance.choice(REMARKS)}\n')]
    own = [
        new_markdown_cell(f'{chance.choice(REMARKS)} ({chance.randrange(1000)})'),
        new_code_cell(_lines(chance).lstrip()),
    ]
    for cell in own:
        cell.id = f'own-{chance.randrange(16**8):08x}'
        notebook.cells.insert(chance.randrange(len(notebook.cells) + 1), cell)
    return nbformat.writes(notebook)


@cache
def _kept(sample: str) -> tuple[str, frozenset[str]]:
    """Return a sample as it would be handed in, and the sources of unanswered answer cells."""
    release = Course().release(assignment_of(PATHS[sample]))
    untouched = frozenset(cell.source for cell in release.cells if _is_answer(cell))
    return rebased(PATHS[sample], with_demos=True), untouched


def _is_answer(cell: NotebookNode) -> bool:
    return grade_id(cell) is not None and role(cell) == 'answer'


def _lines(chance: random.Random) -> str:
    """Return lines of Python without any effect on answers."""
    blank = '\n' * chance.randrange(1, 4)
    return f'{blank}# {chance.choice(REMARKS)}\nprint({chance.choice(REMARKS)!r}){blank}'


if __name__ == '__main__':
    zip_up(synthetic_class(int(sys.argv[1])), Path(sys.argv[2]))
