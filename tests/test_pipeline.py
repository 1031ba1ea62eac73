import nbformat
import pytest
from sample_class import PATHS, assignment_of

from grader.course import Course
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.storage.pipeline import make_sanitized_template, sanitize_restored
from grader.storage.registering import register

NAMES = (
    '02_joint_state-pass-helper_in_the_last_cell',
    '03_publisher-fail-edited_grade_cells',
    '03_publisher-pass-deleted_grade_cells',
    '03_publisher-pass-repeated_grade_cells',
    '03_publisher-pass-split_answer',
    '05_command_line-fail-untouched',
)


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    course = Course(gradebook=tmp_path_factory.mktemp('pipeline') / 'gradebook')
    for assignment in {assignment_of(PATHS[name]) for name in NAMES}:
        register(course, assignment)
    return course


@pytest.mark.parametrize('name', NAMES)
def test_restoring_from_a_prepared_template_equals_preparing_afterwards(name, course, tmp_path):
    assignment = assignment_of(PATHS[name])
    (tmp_path / f'{assignment}.ipynb').write_bytes(PATHS[name].read_bytes())
    submission = read_submission(tmp_path, student_id='ada', assignment=assignment)
    notebook = submission.notebook or nbformat.v4.new_notebook()
    one = sanitize_restored(
        course, assignment, restore(notebook, course.template(assignment)).notebook
    )
    other = restore(notebook, make_sanitized_template(course, assignment)).notebook
    assert one == other
    assert any('checksum' in cell.metadata.get('nbgrader', {}) for cell in other.cells)
    nbformat.validate(other)
