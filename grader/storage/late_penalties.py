"""Late submissions: due dates, extensions and what lateness costs, all from one file.

gradebook/deadlines.toml is optional, and so is each part of it; docs/for-instructors.md has an
example. `./course due` writes [due] and [extended], or an editor does.

`grader/storage/resubmissions.py` says what [resubmissions] may hold.

A submission was handed in when its timestamp.txt says; without one it was in time.
"""

import logging

from nbformat import NotebookNode
from nbgrader.plugins import BasePlugin, LateSubmissionPlugin
from nbgrader.preprocessors import AssignLatePenalties
from traitlets import Any, Type

from grader.course import Course
from grader.storage.deadlines import Deadlines, deadlines
from grader.storage.lateness import tell_what_is_due

_SILENT = logging.getLogger(__name__)
"""What lateness takes off is shown with the score; nbgrader would log it for each notebook."""
_SILENT.setLevel(logging.ERROR)


class LatePolicy(LateSubmissionPlugin):
    """nbgrader's plugin for what lateness costs: as the course's file says."""

    def late_submission_penalty(
        self, student_id: str, score: float, total_seconds_late: float
    ) -> float | None:
        """Return the points to take off, or None."""
        return self.parent.deadlines.penalty(score, total_seconds_late)


class LatePenalties(AssignLatePenalties):
    """Tell the gradebook what is due when, and let the plugin say what lateness costs."""

    plugin_class = Type(LatePolicy, klass=BasePlugin).tag(config=True)
    log = Any(_SILENT)

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Give one submission its due date and its penalty; the notebook stays as it is."""
        at = resources['nbgrader']
        assignment, student = at['assignment'], at['student']
        gradebook = Course.of_nbgrader(resources).gradebook
        self.deadlines = deadlines(gradebook) or Deadlines()
        # nbgrader opens the database once more, and most are in time
        if tell_what_is_due(gradebook, at['db_url'], assignment, student):
            return super().preprocess(nb, resources)
        return nb, resources
