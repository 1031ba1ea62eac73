"""nbgrader's checksum of each graded cell of a lesson, made once for each version of it."""

import hashlib
import json

from nbformat import NotebookNode

from grader.common.files import write_whole
from grader.common.versions import software_hash
from grader.course import Course
from grader.notebook.restore import grade_id
from grader.storage.pipeline import apply_preprocessors, resources_of

FOLDER = 'lessons'
"""In the gradebook: the checksums of each lesson. A file removed there is made again."""
SAVE_CELLS = 'nbgrader.preprocessors.SaveCells'


def lesson_to_register(course: Course, assignment: str) -> NotebookNode:
    """Return a lesson as the gradebook stores it. Raises CourseError if it can't be released."""
    from grader.authoring.release_passes import PASSES  # nbconvert: imported only when needed
    from grader.authoring.source_faults import refuse_faulty

    refuse_faulty(course, [assignment])
    passes = PASSES[: PASSES.index(SAVE_CELLS)]
    return apply_preprocessors(passes, course.source(assignment), resources_of(course, assignment))


def checksums(course: Course, assignment: str) -> dict[str, str]:
    """Return the checksum of each graded cell that the gradebook should have of the lesson.

    They depend on the lesson's text and the grader's code; if both are the same, they are reused.
    """
    path = course.gradebook / FOLDER / f'{assignment}.json'
    made_from = _source_digest(course, assignment)
    try:
        kept = json.loads(path.read_text(encoding='utf-8'))
        if made_from and kept['made_from'] == made_from:
            return {str(name): str(checksum) for name, checksum in kept['checksums'].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass  # not there yet, or damaged: made again
    made = {
        grade_id(cell) or '': cell.metadata['nbgrader']['checksum']
        for cell in lesson_to_register(course, assignment).cells
        if 'checksum' in cell.metadata.get('nbgrader', {})
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, json.dumps({'made_from': made_from, 'checksums': made}))
    return made


def _source_digest(course: Course, assignment: str) -> str:
    try:
        lesson = course.source_path(assignment).read_bytes()
    except OSError:
        return ''  # reading the lesson raises the reason
    return hashlib.sha256(f'{software_hash()}\n'.encode() + lesson).hexdigest()
