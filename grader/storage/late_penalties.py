"""Late submissions: due dates, extensions and penalties, all from one file.

gradebook/deadlines.toml is optional, and so is each part of it; docs/for-instructors.md has an
example. [due] and [extended] are written by `./course due` or by hand.
`grader/storage/resubmissions.py` describes [resubmissions].

timestamp.txt says when a submission was handed in; without this file it was in time.
"""

import logging

from nbformat import NotebookNode
from nbgrader.plugins import BasePlugin, LateSubmissionPlugin
from nbgrader.preprocessors import AssignLatePenalties
from traitlets import Any, Type

from grader.course import Course
from grader.storage.deadlines import Deadlines, deadlines
from grader.storage.lateness import store_due_date

_SILENT = logging.getLogger(__name__)
"""The penalty is shown with the score; nbgrader would also log it for each notebook."""
_SILENT.setLevel(logging.ERROR)


class LatePolicy(LateSubmissionPlugin):
    """nbgrader's plugin for late penalties, with the rules of the course's file."""

    def late_submission_penalty(
        self, student_id: str, score: float, total_seconds_late: float
    ) -> float | None:
        """Return the points to take off, or None."""
        return self.parent.deadlines.penalty(score, total_seconds_late)


class LatePenalties(AssignLatePenalties):
    """Write due dates into the gradebook, and let the plugin compute the late penalty."""

    plugin_class = Type(LatePolicy, klass=BasePlugin).tag(config=True)
    log = Any(_SILENT)

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Give one submission its due date and its penalty; the notebook is not changed."""
        at = resources['nbgrader']
        assignment, student = at['assignment'], at['student']
        gradebook = Course.of_nbgrader(resources).gradebook
        self.deadlines = deadlines(gradebook) or Deadlines()
        # nbgrader would open the database again, and most submissions are in time
        if store_due_date(gradebook, at['db_url'], assignment, student):
            return super().preprocess(nb, resources)
        return nb, resources
