"""The preprocessor that copies the gradebook's scores and comments into a graded notebook."""

from nbformat import NotebookNode
from nbgrader.api import MissingEntry
from nbgrader.preprocessors import ClearHiddenTests, GetGrades

from grader.common.errors import DamagedResult
from grader.course import Course
from grader.notebook.restore import KEY, grade_id
from grader.storage.database import open_database
from grader.storage.held_scores import held_score
from grader.storage.rewritten_answers import reason_today
from grader.storage.submission_rows import SubmissionRows


class GatherVerdicts(GetGrades):
    """Add scores and comments to the notebook, and remove hidden tests and tracebacks."""

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Do what nbgrader does, but without a database query for each cell.

        Raises DamagedResult if the database has no scores of the submission.
        """
        at = resources['nbgrader']
        self.notebook_id, self.assignment_id = at['notebook'], at['assignment']
        self.student_id = at['student']
        whose = self.student_id, self.assignment_id
        with open_database(at['db_url']) as book:
            try:
                submission = book.find_submission(self.assignment_id, self.student_id)
            except MissingEntry:
                raise DamagedResult(_unknown(*whose, resources)) from None
            self.gradebook = SubmissionRows(book, submission, self.notebook_id)
            for index, cell in enumerate(nb.cells):
                self.preprocess_cell(cell, resources, index)
            held = held_score(book, *whose)
        assert held is not None  # it was found above
        if held.late:
            self.log.info('Late submission penalty: %s', held.late)
        at |= {'score': held.score, 'max_score': held.max_score, 'late_penalty': held.late}
        return nb, resources

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Prepare one cell for the page."""
        cell, resources = super().preprocess_cell(cell, resources, index)
        if cell.metadata.get('nbgrader', {}).get('grade') and cell.cell_type == 'code':
            cell, resources = ClearHiddenTests().preprocess_cell(cell, resources, index)
            for output in cell.outputs:
                if output.output_type == 'error':
                    output.traceback = [output.evalue]
        return cell, resources

    def _get_comment(self, cell: NotebookNode, resources: dict) -> None:
        """Add what a person wrote; nbgrader's own comment says, in English, what a reason says."""
        found = self.gradebook.find_comment(
            grade_id(cell), self.notebook_id, self.assignment_id, self.student_id
        )
        cell.metadata.nbgrader['comment'] = found.manual_comment

    def _get_score(self, cell: NotebookNode, resources: dict) -> None:
        super()._get_score(cell, resources)
        grade = self.gradebook.find_grade(
            grade_id(cell), self.notebook_id, self.assignment_id, self.student_id
        )
        verdict = cell.metadata.setdefault(KEY, NotebookNode())
        verdict.by_hand = grade.manual_score is not None
        verdict.waits = grade.auto_score is None and not verdict.by_hand
        former = verdict.get('reason')
        verdict.reason = reason_today(verdict, by_hand=verdict.by_hand)
        if former and not verdict.reason and cell.cell_type == 'code':
            outputs = cell.outputs  # one of them repeats the reason
            cell.outputs = [each for each in outputs if each.get('text', '').strip() != former]


def _unknown(student: str, assignment: str, resources: dict) -> str:
    """Return what to do about a graded notebook that has no scores in the database."""
    folder = Course.of_nbgrader(resources).folder('autograded', student, assignment)
    return (
        f'the database has no scores of it. ./course grade --student {student} grades it again; '
        f'if it is not to count any more, remove {folder}'
    )
