"""The pages beside the lessons: the contents, made from them, the core terms, what comes next."""

import re
import shutil
from pathlib import Path

from my_robot_basics.validate.cells import title_of
from nbformat import NotebookNode, v4, write

from grader.course import Course

INDEX, TERMS, NEXT = 'index.ipynb', 'terms.md', 'what_next.md'
COPIED = (TERMS, NEXT)
"""Pages that lie in solutions/ as students get them."""

WELCOME = """\
# Topics in ROS 2

A course in notebooks: real ROS 2 nodes run in them and move an arm with two links. Open the first
lesson; each lesson ends with a link to the next one.
"""
HOW_IT_WORKS = """\
## How a lesson works

- Run its cells from top to bottom with **Shift+Enter**. Predict what a cell will show
  before you run it.
- Write your answer where it says `YOUR CODE HERE` or `YOUR ANSWER HERE`, or fix the code
  that is there.
- **Validate**, in the bar above a lesson, runs your answers and shows which checks pass.
- You get your points when your notebook is graded. Some checks run only then.
"""
TO_THE_PAGES = {
    TERMS: f'Each of the [core terms]({TERMS}) is explained in one sentence.',
    NEXT: f'After the last lesson: [what next]({NEXT}).',
}


def write_pages(course: Course, folder: Path, *, metadata: dict) -> None:
    """Write the index notebook with that metadata, and copy the other pages that there are."""
    for page in copied_pages(course):
        shutil.copyfile(course.root / 'solutions' / page, folder / page)
    index = make_index(course)
    index.metadata = metadata
    write(index, folder / INDEX)


def copied_pages(course: Course) -> list[str]:
    """Return the names of those pages in solutions/ that students get as they are."""
    return [page for page in COPIED if (course.root / 'solutions' / page).exists()]


def make_index(course: Course) -> NotebookNode:
    """Return the table of contents as a notebook: each lesson, what it teaches, its points."""
    lessons = {name: course.source(name) for name in course.assignments()}
    rows = [_row(name, lesson) for name, lesson in lessons.items()]
    total = sum(_points(lesson) for lesson in lessons.values())
    minutes = sum(float(_needs(lesson.cells[0].source)[1] or 0) for lesson in lessons.values())
    table = [
        '| lesson | you will be able to | you need | minutes | exercises | points |',
        '|---|---|---|---|---|---|',
        *rows,
        f'| **all together** | | | **{minutes:g}** | | **{total:g}** |',
    ]
    pages = ' '.join(TO_THE_PAGES[page] for page in copied_pages(course))
    about = f'{HOW_IT_WORKS}\n{pages}'.strip()
    texts = {'contents': '\n'.join([WELCOME, *table]), 'how_it_works': about}
    return v4.new_notebook(
        cells=[v4.new_markdown_cell(text, id=id_) for id_, text in texts.items()]
    )


def _row(name: str, lesson: NotebookNode) -> str:
    opening = lesson.cells[0].source
    title = title_of(lesson)
    marks = [cell.metadata.get('nbgrader', {}) for cell in lesson.cells]
    exercises = ', '.join(f'`{mark["grade_id"]}`' for mark in marks if mark.get('solution'))
    link = f'[{title}]({name}/{name}.ipynb)'
    abilities, (needs, minutes) = '; '.join(_abilities(opening)), _needs(opening)
    points = f'{_points(lesson):g}'
    return '| ' + ' | '.join([link, abilities, needs, minutes, exercises, points]) + ' |'


def _needs(opening: str) -> tuple[str, str]:
    """Return what a lesson needs before it, and its minutes, as its first cell says; or blanks."""
    found = re.search(
        r'^\| you need \| time \|\n.*\n\| (.+) \| about (\d+) minutes \|$', opening, re.M
    )
    return (found[1], found[2]) if found else ('', '')


def _points(lesson: NotebookNode) -> float:
    return sum(cell.metadata.get('nbgrader', {}).get('points', 0) for cell in lesson.cells)


def _abilities(opening: str) -> list[str]:
    """Return the items of a lesson's numbered list, each in one line that fits into a table."""
    items = re.findall(r'^\d+\. (.+(?:\n[^\d\n|].*)*)', opening, re.MULTILINE)
    return [' '.join(item.split()).rstrip(',.;').replace('|', r'\|') for item in items]
