"""The pages beside the lessons: the contents page, the core terms, and what comes next."""

from functools import partial
from pathlib import Path

from babel import Locale
from my_robot_basics.language.speaking import LANGUAGE
from my_robot_basics.validate.lessons.cells import KEY
from my_robot_basics.validate.progress.progress import CONTENTS
from nbformat import NotebookNode, from_dict, v4, write

from grader.authoring.contents_rows import (
    JOINED,
    join_sentences,
    minutes_of,
    points_of,
    progress_row,
    row,
)
from grader.authoring.editions import ENGLISH, Edition, editions
from grader.authoring.quizzes import lesson_before, quizzes
from grader.course import Course

INDEX, TERMS, NEXT = 'index.ipynb', 'terms.md', 'what_next.md'
COPIED = (TERMS, NEXT)
"""Pages in solutions/ that students get unchanged."""

WELCOME = """\
# ROS 2 on a two-link arm

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


HEADER = '| lesson | you will be able to | you need | minutes | exercises | points |'
TOTAL = 'all together'
TEXTS = (WELCOME, HEADER, TOTAL, JOINED, HOW_IT_WORKS, *TO_THE_PAGES.values())
"""All texts of the contents page itself."""
PART = 'index'
"""The name of its catalogue."""


def write_pages(
    course: Course, folder: Path, *, metadata: dict, edition: Edition | None = None
) -> None:
    """Write the contents page with that metadata, and the other pages that exist."""
    edition = edition or Edition()
    for page in copied_pages(course):
        english = (course.root / 'solutions' / page).read_text(encoding='utf-8')
        text = edition.text(Path(page).stem, english)
        (folder / page).write_text(text, encoding='utf-8')
    for name, quiz in quizzes(course).items():
        quiz.metadata = from_dict(metadata)
        write(edition.notebook(Path(name).stem, quiz), folder / name)
    index = make_index(course, edition)
    index.metadata |= from_dict(metadata)
    write(index, folder / INDEX)


def copied_pages(course: Course) -> list[str]:
    """Return the names of the pages in solutions/ that students get unchanged."""
    return [page for page in COPIED if (course.root / 'solutions' / page).exists()]


def make_index(course: Course, edition: Edition | None = None) -> NotebookNode:
    """Return the contents page as a notebook: each lesson, what it teaches, its points."""
    edition = edition or Edition()
    lessons = {name: edition.notebook(name, course.source(name)) for name in course.assignments()}
    tests = {name: edition.notebook(Path(name).stem, q) for name, q in quizzes(course).items()}
    put = partial(edition.text, PART)
    rows = {name: [row(f'{name}/{name}.ipynb', lesson, put)] for name, lesson in lessons.items()}
    for name, quiz in tests.items():
        rows[lesson_before(name, [*lessons])].append(row(name, quiz, put))
    total = sum(map(points_of, lessons.values()))
    minutes = sum(map(minutes_of, [*lessons.values(), *tests.values()]))
    table = [
        put(HEADER),
        '|---|---|---|---|---|---|',
        *(line for lines in rows.values() for line in lines),
        f'| **{put(TOTAL)}** | | | **{minutes:g}** | | **{total:g}** |',
    ]
    pages = join_sentences(put(TO_THE_PAGES[page]) for page in copied_pages(course))
    about = f'{edition.text(PART, HOW_IT_WORKS)}\n{pages}'.strip()
    welcome = [edition.text(PART, WELCOME), *_to_other_editions(course, edition)]
    texts = {'contents': '\n'.join([*welcome, *table]), 'how_it_works': about}
    ours: dict = {CONTENTS: [progress_row(name, lesson) for name, lesson in lessons.items()]}
    if edition.language != ENGLISH:
        ours[LANGUAGE] = edition.language
    return v4.new_notebook(
        cells=[v4.new_markdown_cell(text, id=id_) for id_, text in texts.items()],
        metadata={KEY: ours},
    )


def _to_other_editions(course: Course, edition: Edition) -> list[str]:
    """Return a line of links to the contents page in the other languages, in their own names."""
    known = [Edition(), *editions(course)]
    top = '' if edition.language == ENGLISH else '../'
    links = [
        f'[{_name(each.language)}]({top}{_folder(each)}{INDEX})'
        for each in known
        if each.language != edition.language
    ]
    return [' · '.join(links) + '\n'] if links else []


def _name(language: str) -> str:
    return (Locale.parse(language).get_language_name(language) or language).capitalize()


def _folder(edition: Edition) -> str:
    return '' if edition.language == ENGLISH else f'{edition.language}/'
