"""The quizzes: notebooks beside the lessons, with questions that running a cell checks."""

from collections.abc import Iterator
from pathlib import Path

from nbformat import NotebookNode, read

from grader.course import Course

QUIZZES = {'quiz_topics.ipynb': '07_common_errors', 'quiz_services.ipynb': ''}
"""Quizzes in solutions/, with the lesson that each follows; '' for the last lesson."""


def quizzes(course: Course) -> dict[str, NotebookNode]:
    """Return the quizzes that exist, by name, as they are released: without outputs."""
    paths = [course.root / 'solutions' / name for name in QUIZZES]
    return {path.name: _read(path) for path in paths if path.exists()}


def lesson_before(quiz: str, lessons: list[str]) -> str:
    """Return the lesson that a quiz follows."""
    return QUIZZES[quiz] if QUIZZES[quiz] in lessons else lessons[-1]


def unknown_quizzes(course: Course) -> Iterator[str]:
    """Yield a line for each notebook that is beside the lessons and is no quiz."""
    for path in sorted((course.root / 'solutions').glob('[!.]*.ipynb')):
        if path.name not in QUIZZES:
            yield (
                f'solutions/{path.name} is not released: a lesson is solutions/NAME/NAME.ipynb,'
                ' and a quiz has its row in grader/authoring/quizzes.py'
            )


def _read(path: Path) -> NotebookNode:
    quiz = read(path, as_version=4)
    for cell in quiz.cells:
        if cell.cell_type == 'code':
            cell.outputs, cell.execution_count = [], None
    return quiz
