"""Feedback for students: each check's reason and picture, what to try, never a hidden test."""

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from nbconvert.exporters import Exporter
from nbformat import NotebookNode
from traitlets.config import Config

from grader.common.errors import DamagedResult
from grader.common.files import write_whole
from grader.common.futures import run_ahead
from grader.common.parsing import AT_ONCE, Limits, ParsingFailed, cancel_requests, parse
from grader.common.text import printable
from grader.course import Course
from grader.notebook.submission import SECRET, TIMESTAMP
from grader.storage.database import has_database, share_engine
from grader.storage.gradebook import recover
from grader.storage.lateness import recount_late_penalties
from grader.storage.pipeline import resources_of
from grader.storage.records import graded_notebook

ABOUT = ('student', 'assignment', 'score', 'max_score', 'late_penalty')
LIMITS = Limits(cpu_sec=10)
"""An ordinary page takes a tenth of a second of CPU time."""
FEEDBACK_PASSES = ('grader.report.gather_verdicts.GatherVerdicts',)
"""Preprocessors that nbgrader applies to a graded notebook before it is shown."""


class FeedbackPage(Exporter):
    """Replaces nbgrader's own feedback page, also in `nbgrader generate_feedback`."""

    file_extension = '.html'
    output_mimetype = 'text/html'

    def from_notebook_node(  # type: ignore[override]  # other exporters return text, too
        self, nb: NotebookNode, resources: dict | None = None, **options: object
    ) -> tuple[str, dict]:
        """Return the feedback page of a graded notebook as HTML."""
        nb, resources = self.gather_verdicts(nb, resources, **options)
        return _page(nb, resources['nbgrader']), resources

    def gather_verdicts(
        self, nb: NotebookNode, resources: dict | None = None, **options: object
    ) -> tuple[NotebookNode, dict]:
        """Return the notebook with verdicts, and the resources that a page is made from."""
        return super().from_notebook_node(nb, resources, **options)


def _page(notebook: NotebookNode, about: dict) -> str:
    """Return the page, made in a process with limits. Raises ParsingFailed if that fails."""
    about = {key: about[key] for key in ABOUT if key in about}
    try:
        return parse('grader.report.page:render_page', notebook, about, limits=LIMITS)
    except ParsingFailed as why:
        said = f'Your text is shown as you typed it: {why} to show it as it is meant.'
        return parse('grader.report.page:render_page', notebook, about, said, limits=LIMITS)


def write_feedback(
    course: Course, *, say: Callable[[str], None] = lambda line: None
) -> list[Path]:
    """Write a page for each graded submission under gradebook/feedback/; return their paths.

    `say` gets a line for each page that is new or has changed.
    """
    exporter = page_exporter()
    recover(course)
    if has_database(course):
        recount_late_penalties(course)
    found = sorted(course.folder('autograded', '', '').glob('*/*/*.ipynb'))
    whose = [each.parts[-3:] for each in found if each.stem == each.parts[-2]]
    pages = []
    with share_engine(course.db_url), _threads() as threads:

        def start(each: tuple[str, ...]) -> 'Future[str]':
            student, assignment, _ = each
            return threads.submit(_page, *_page_inputs(course, student, assignment, exporter))

        # other processes make pages while this one reads the next submissions from the database
        for (student, assignment, _), work in run_ahead(whose, start, at_most=2 * AT_ONCE):
            try:
                place, is_new = _put(course, student, assignment, work.result())
            except (DamagedResult, ParsingFailed) as why:
                say(printable(f'{assignment} of {student} has no page of feedback: {why}'))
                continue
            except Exception as error:
                error.add_note(f'This was the page of {student} for {assignment}.')
                raise
            if is_new:
                say(str(place))
            pages.append(place)
    return pages


@contextmanager
def _threads() -> Iterator[ThreadPoolExecutor]:
    """Provide threads that wait for pages; if the block raises, running requests are ended."""
    threads = ThreadPoolExecutor(AT_ONCE)
    try:
        yield threads
    except BaseException:
        threads.shutdown(wait=False, cancel_futures=True)
        cancel_requests()
        raise
    finally:
        threads.shutdown()


def page_exporter() -> FeedbackPage:
    """Return an exporter of pages: one is enough for any number of pages."""
    exporter = FeedbackPage(config=Config({'Exporter': {'default_preprocessors': []}}))
    for name in FEEDBACK_PASSES:
        exporter.register_preprocessor(name)
    return exporter


def write_page(
    course: Course, student: str, assignment: str, exporter: FeedbackPage
) -> tuple[Path, bool]:
    """Write the page of a graded submission; return its path, and whether it has changed.

    The files that `nbgrader release_feedback` needs are put beside it. Raises ParsingFailed if
    the page can't be made.
    """
    return _put(
        course, student, assignment, _page(*_page_inputs(course, student, assignment, exporter))
    )


def _page_inputs(
    course: Course, student: str, assignment: str, exporter: FeedbackPage
) -> tuple[NotebookNode, dict]:
    notebook = graded_notebook(course, student, assignment)
    shown, at = exporter.gather_verdicts(notebook, resources_of(course, assignment, student))
    return shown, at['nbgrader']


def _put(course: Course, student: str, assignment: str, html: str) -> tuple[Path, bool]:
    """Write a page unless it is the same already; return its path, and whether it was written."""
    graded = course.folder('autograded', student, assignment)
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
