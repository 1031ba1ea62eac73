"""The pages beside the lessons: the table of contents, made from them, and the core terms."""

import re
import shutil
from pathlib import Path

from my_robot_basics.validate.cells import title_of
from nbformat import NotebookNode, v4, write

from grader.course import Course

INDEX, TERMS = 'index.ipynb', 'terms.md'

WELCOME = """\
# Topics in ROS 2

A course in notebooks: real nodes run in them, on an arm with two links. Open the first lesson;
each one ends with the way to the next.
"""
HOW_IT_WORKS = """\
## How a lesson works

- Run its cells from top to bottom with **Shift+Enter**, and guess before you run.
- Write your answer where it says `YOUR CODE HERE` or `YOUR ANSWER HERE`, or mend what is there.
- **Validate**, in the bar above a lesson, runs your answers and shows which checks pass.
- Your points are given when your notebook is graded. Some checks run only then.
"""
TO_THE_TERMS = f"""
A word that you do not know? Each of the [core terms]({TERMS}) is told in one sentence.
"""


def write_pages(course: Course, folder: Path, *, metadata: dict) -> None:
    """Write the index notebook with that metadata, and copy the page of terms if there is one."""
    terms = course.root / 'solutions' / TERMS
    if terms.exists():
        shutil.copyfile(terms, folder / TERMS)
    index = make_index(course, has_terms=terms.exists())
    index.metadata = metadata
    write(index, folder / INDEX)


def make_index(course: Course, *, has_terms: bool) -> NotebookNode:
    """Return the table of contents as a notebook: each lesson, what it teaches, its points."""
    lessons = {name: course.source(name) for name in course.assignments()}
    rows = [_row(name, lesson) for name, lesson in lessons.items()]
    total = sum(_points(lesson) for lesson in lessons.values())
    table = [
        '| lesson | you will be able to | exercises | points |',
        '|---|---|---|---|',
        *rows,
        f'| | | **all together** | **{total:g}** |',
    ]
    about = HOW_IT_WORKS + (TO_THE_TERMS if has_terms else '')
    texts = {'contents': '\n'.join([WELCOME, *table]), 'how_it_works': about.strip()}
    return v4.new_notebook(
        cells=[v4.new_markdown_cell(text, id=id_) for id_, text in texts.items()]
    )


def _row(name: str, lesson: NotebookNode) -> str:
    opening = lesson.cells[0].source
    title = title_of(lesson)
    marks = [cell.metadata.get('nbgrader', {}) for cell in lesson.cells]
    exercises = ', '.join(f'`{mark["grade_id"]}`' for mark in marks if mark.get('solution'))
    link = f'[{title}]({name}/{name}.ipynb)'
    return f'| {link} | {"; ".join(_abilities(opening))} | {exercises} | {_points(lesson):g} |'


def _points(lesson: NotebookNode) -> float:
    return sum(cell.metadata.get('nbgrader', {}).get('points', 0) for cell in lesson.cells)


def _abilities(opening: str) -> list[str]:
    """Return the items of a lesson's numbered list, each in one line that fits into a table."""
    items = re.findall(r'^\d+\. (.+(?:\n[^\d\n|].*)*)', opening, re.MULTILINE)
    return [' '.join(item.split()).rstrip(',.;').replace('|', r'\|') for item in items]
