"""The quizzes: notebooks beside the lessons, with questions that are checked by running."""

from pathlib import Path

from nbformat import NotebookNode, read

from grader.course import Course

QUIZZES = {'quiz_topics.ipynb': '07_common_errors', 'quiz_services.ipynb': ''}
"""Each in solutions/, and behind which lesson it comes; '': behind the last one."""


def quizzes(course: Course) -> dict[str, NotebookNode]:
    """Return those that there are, by their names, as they are given out: nothing was run."""
    paths = [course.root / 'solutions' / name for name in QUIZZES]
    return {path.name: _read(path) for path in paths if path.exists()}


def lesson_before(quiz: str, lessons: list[str]) -> str:
    """Return behind which of the lessons a quiz comes."""
    return QUIZZES[quiz] if QUIZZES[quiz] in lessons else lessons[-1]


def _read(path: Path) -> NotebookNode:
    quiz = read(path, as_version=4)
    for cell in quiz.cells:
        if cell.cell_type == 'code':
            cell.outputs, cell.execution_count = [], None
    return quiz
