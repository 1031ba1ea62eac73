"""Whether an undefined name is misspelled: then no other cell of the notebook can bind it."""

import re

from nbformat import NotebookNode

from my_robot_basics.validate.lessons.cells import is_code
from my_robot_basics.validate.lessons.exercises import Exercise
from my_robot_basics.validate.lessons.names import names_of

_WORD = re.compile(r'\w+')
_LINE_MAGIC = re.compile(r'^[ \t]*%(?!%)', re.MULTILINE)
"""A line magic: some bind names, as `%pylab` does."""


def are_misspelled(names: set[str], notebook: NotebookNode, exercise: Exercise) -> bool:
    """Whether no cell but the answer contains one of these names in its text.

    A cell that may bind names which its text does not show, such as by a star import, counts as
    containing them.
    """
    cells = enumerate(notebook.cells)
    texts = [cell.source for i, cell in cells if is_code(cell) and i != exercise.answer]
    return not any(
        names & {*_WORD.findall(text)} or names_of(text).binds_more or _LINE_MAGIC.search(text)
        for text in texts
    )
