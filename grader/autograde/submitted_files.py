"""How nbgrader's own commands read submissions: without parsing students' text themselves.

nbgrader would read a notebook with nbformat, which checks its whole schema: 30,000 outputs, in
0.7 MB, take 40 s and 1.4 GB. It would read times with dateutil, which raises unexpected
exceptions for some texts, and the command would end.
"""

from datetime import datetime
from pathlib import Path
from typing import IO

import nbformat
from nbconvert.exporters import NotebookExporter
from nbgrader.coursedir import CourseDirectory

from grader.autograde.preprocessors import RestoreSubmission
from grader.common.dates import date_of
from grader.course import Course
from grader.notebook.submission import TIMESTAMP


class AutogradeExporter(NotebookExporter):
    """Reads notebooks that nbgrader wrote; submitted ones are left to RestoreSubmission."""

    def from_file(  # type: ignore[override]  # nbconvert's own exporter of notebooks returns text
        self, file_stream: IO[str], resources: dict | None = None, **options: object
    ) -> tuple[str, dict]:
        """Return a notebook after the preprocessors, as JSON."""
        if not any(isinstance(each, RestoreSubmission) for each in self._preprocessors):
            return super().from_file(file_stream, resources, **options)  # type: ignore[return-value]
        return self.from_notebook_node(nbformat.v4.new_notebook(), resources, **options)


def existing_timestamp(course: CourseDirectory, dest_path: str) -> datetime | None:
    """Return when a submission was handed in (UTC, without a time zone); None if unknown."""
    when = date_of(Path(dest_path, TIMESTAMP))
    return when and when.replace(tzinfo=None)


def read_timestamps_as_we_do() -> None:
    """Patch nbgrader's commands to read timestamps with our parser; no option can do it."""
    CourseDirectory.get_existing_timestamp = existing_timestamp


def files_of_solved_packages(course: Course) -> dict[str, list[str]]:
    """Return the files of packages in solutions/, by assignment, relative to its folder.

    nbgrader must not overwrite the students' own packages in autograded/ with them.
    """
    found = {}
    for assignment in course.assignments():
        folder = course.source_path(assignment).parent
        files = [
            path for name in course.packages(assignment) for path in (folder / name).rglob('*')
        ]
        found[assignment] = sorted(
            str(path.relative_to(folder)) for path in files if path.is_file()
        )
    return found
