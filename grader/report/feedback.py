"""What a student reads: each check's reason and picture, what to try next, never a hidden test."""

from collections.abc import Callable
from pathlib import Path

import nbformat
from nbconvert.exporters import Exporter
from nbformat import NotebookNode
from nbgrader.preprocessors import ClearHiddenTests, GetGrades
from traitlets.config import Config

from grader.common.files import write_whole
from grader.common.parsing import Limits, ParsingFailed, parse
from grader.course import Course
from grader.notebook.restore import KEY, grade_id
from grader.notebook.submission import SECRET, TIMESTAMP
from grader.storage.gradebook import recover
from grader.storage.pipeline import resources_of

ABOUT = ('student', 'assignment', 'score', 'max_score', 'late_penalty')
LIMITS = Limits(cpu_sec=10)
"""An ordinary page takes a tenth of a second of processor time."""
FEEDBACK_PASSES = ('grader.report.feedback.GatherVerdicts',)
"""What nbgrader does with a graded notebook before it shows it."""


class GatherVerdicts(GetGrades):
    """Put scores and comments into the notebook, and take hidden tests and tracebacks out."""

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Make one cell ready to be shown."""
        cell, resources = super().preprocess_cell(cell, resources, index)
        if cell.metadata.get('nbgrader', {}).get('grade') and cell.cell_type == 'code':
            cell, resources = ClearHiddenTests().preprocess_cell(cell, resources, index)
            for output in cell.outputs:
                if output.output_type == 'error':
                    output.traceback = [output.evalue]
        return cell, resources

    def _get_score(self, cell: NotebookNode, resources: dict) -> None:
        super()._get_score(cell, resources)
        grade = self.gradebook.find_grade(
            grade_id(cell), self.notebook_id, self.assignment_id, self.student_id
        )
        verdict = cell.metadata.setdefault(KEY, NotebookNode())
        verdict.by_hand = grade.manual_score is not None
        verdict.waits = grade.auto_score is None and not verdict.by_hand


class FeedbackPage(Exporter):
    """Our page in the place of nbgrader's own, for `nbgrader generate_feedback` too."""

    file_extension = '.html'
    output_mimetype = 'text/html'

    def from_notebook_node(  # type: ignore[override]  # other exporters return text, too
        self, nb: NotebookNode, resources: dict | None = None, **options: object
    ) -> tuple[str, dict]:
        """Return the page of a graded notebook as HTML."""
        nb, resources = super().from_notebook_node(nb, resources, **options)
        return _page(nb, resources['nbgrader']), resources


def _page(notebook: NotebookNode, about: dict) -> str:
    """Return the page, made in a process with limits. Raises ParsingFailed where that can't be."""
    about = {key: about[key] for key in ABOUT if key in about}
    try:
        return parse('grader.report.page:page', notebook, about, limits=LIMITS)
    except ParsingFailed as why:
        said = f'Your text is shown as you typed it: {why} to show it as it is meant.'
        return parse('grader.report.page:page', notebook, about, said, limits=LIMITS)


def write_feedback(
    course: Course, *, say: Callable[[str], None] = lambda line: None
) -> list[Path]:
    """Write a page for each graded submission under gradebook/feedback/; return their paths.

    `say` gets a line for each page that is new or says something else than before.
    """
    exporter = page_exporter()
    recover(course)
    pages = []
    for graded in sorted(course.folder('autograded', '', '').glob('*/*/*.ipynb')):
        student, assignment = graded.parts[-3:-1]
        if graded.stem != assignment:
            continue
        try:
            place, is_new = write_page(course, student, assignment, exporter)
        except ParsingFailed as why:
            say(f'{assignment} of {student} has no page of feedback, for {why}')
            continue
        if is_new:
            say(str(place))
        pages.append(place)
    return pages


def page_exporter() -> FeedbackPage:
    """Return what makes pages: one is enough for any number of them."""
    exporter = FeedbackPage(config=Config({'Exporter': {'default_preprocessors': []}}))
    for name in FEEDBACK_PASSES:
        exporter.register_preprocessor(name)
    return exporter


def write_page(
    course: Course, student: str, assignment: str, exporter: FeedbackPage
) -> tuple[Path, bool]:
    """Write the page of a graded submission; return its path, and whether it is a new one.

    What `nbgrader release_feedback` wants to know lies beside it then. Raises ParsingFailed where
    no page can be made.
    """
    graded = course.folder('autograded', student, assignment)
    notebook = nbformat.read(graded / f'{assignment}.ipynb', as_version=4)
    html, _ = exporter.from_notebook_node(notebook, resources_of(course, assignment, student))
    folder = course.folder('feedback', student, assignment)
    folder.mkdir(parents=True, exist_ok=True)
    for name in (TIMESTAMP, SECRET):
        if (graded / name).is_file():
            write_whole(folder / name, (graded / name).read_bytes())
    place = folder / f'{assignment}.html'
    if place.exists() and place.read_text(encoding='utf-8') == html:
        return place, False
    write_whole(place, html)
    return place, True
