"""The preprocessor that writes the verdicts of a notebook into nbgrader's database."""

import nbformat
from my_robot_basics.validate.verdicts.verdict import SCORED
from nbformat import NotebookNode
from nbgrader.preprocessors import SaveAutoGrades

from grader.notebook.restore import KEY, grade_id
from grader.storage.database import transaction
from grader.storage.rewritten_answers import EARLIER_POINTS
from grader.storage.submission_rows import SubmissionRows

NO_ANSWER = 'there is no answer'
"""The reason why an empty text answer, which would be graded by hand, earns nothing."""


class SaveGrades(SaveAutoGrades):
    """Store the verdicts of one notebook, all of them or none.

    nbgrader reads a score from a cell's outputs, and gives all points to a cell without outputs.
    So a cell also needs a verdict: without one it has no score, and waits for manual grading.
    """

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Store the scores of an executed notebook."""
        at = resources['nbgrader']
        self.notebook_id, self.assignment_id = at['notebook'], at['assignment']
        self.student_id, self.db_url = at['student'], at['db_url']
        dated = {'timestamp': at['timestamp']} if at.get('timestamp') else {}
        with transaction(self.db_url) as book:
            book.update_or_create_student(self.student_id)
            with book.db.no_autoflush:  # or SQLAlchemy warns of rows that are incomplete
                submission = book.update_or_create_submission(
                    self.assignment_id, self.student_id, **dated
                )
            self.gradebook = SubmissionRows(book, submission, self.notebook_id)
            for index, cell in enumerate(nb.cells):
                self.preprocess_cell(cell, resources, index)
        return nb, resources

    def _add_score(self, cell: NotebookNode, resources: dict) -> None:
        super()._add_score(cell, resources)
        grade = self.gradebook.find_grade(
            grade_id(cell), self.notebook_id, self.assignment_id, self.student_id
        )
        verdict = cell.metadata.setdefault(KEY, nbformat.from_dict({}))
        if EARLIER_POINTS in verdict:
            grade.manual_score = None
            grade.needs_manual_grade = grade.auto_score is None
        if cell.cell_type == 'code' and verdict.get('outcome') not in SCORED:
            grade.auto_score, grade.needs_manual_grade = None, True
        elif cell.cell_type != 'code' and grade.auto_score is not None:
            # an unanswered text need not be graded by hand
            verdict |= {'outcome': 'failed', 'reason': NO_ANSWER, 'notes': []}
