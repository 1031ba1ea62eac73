"""Name a cell as students can find it: by its number from the top, and by its purpose.

JupyterLab does not show nbgrader's cell ids.
"""

import re

from nbformat import NotebookNode

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.spaces import remove_spaces
from my_robot_basics.language.speaking import in_language
from my_robot_basics.validate.lessons.cells import KEY, grade_id, graded_id, is_reset, role
from my_robot_basics.validate.lessons.titles import title_of_check

_NAMED = re.compile(r'\b(?:the )?(?:answer )?(?:cell|check) `([^`]+)`')


def number_of(cells: list[NotebookNode], index: int) -> int:
    """Return a cell's number from the top of the notebook as it was read, from 1, with text."""
    return cells[index].metadata.get(KEY, {}).get('number', index + 1)


def replace_cell_ids(text: str, notebook: NotebookNode, language: str = ENGLISH) -> str:
    """Replace cell ids in a sentence by numbers and purposes; unknown ids stay as they are.

    In a language other than English, the id stays, followed by the number.
    """
    places = {grade_id(cell): i for i, cell in enumerate(notebook.cells) if grade_id(cell)}
    if language != ENGLISH:
        shown = in_language(language, text)
        for each in dict.fromkeys(filter(places.__contains__, _NAMED.findall(text))):
            numbered = f'`{each}` (cell {number_of(notebook.cells, places[each])})'
            shown = shown.replace(f'`{each}`', in_language(language, numbered))
        return remove_spaces(shown)

    def name(found: re.Match[str]) -> str:
        index = places.get(found[1])
        return found[0] if index is None else _name(notebook.cells, index)

    return _NAMED.sub(name, text)


def _name(cells: list[NotebookNode], index: int) -> str:
    cell = cells[index]
    name, kind = graded_id(cell), role(cell)
    exercise = name.rpartition('-')[0]
    if kind == 'answer':
        what = f'the answer to `{name}`'
    elif kind == 'grade':
        what = f'the check “{title_of_check(cell.source) or name}”'
    else:
        what = (
            f'it begins `{exercise}`' if is_reset(cell) else f'it runs the answer to `{exercise}`'
        )
    return f'cell {number_of(cells, index)} ({what})'
