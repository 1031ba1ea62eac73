"""`nbgrader release_feedback`, and the formgrader's button: no student keeps others from feedback.

nbgrader's own ends at the first submission whose secret is missing, empty or not UTF-8: students
write that file, and those who come after them get no feedback.
"""

from glob import glob
from pathlib import Path

from nbgrader.exchange.default import ExchangeReleaseFeedback

from grader.common.text import printable
from grader.notebook.submission import SECRET
from grader.serving.exchange import release_page


class ReleaseAsWeDo(ExchangeReleaseFeedback):
    """Releases each page that has a secret, as `./course serve` does, and names the others.

    `nbgrader_config.py` names it.
    """

    def copy_files(self) -> None:
        """Release the pages of a lesson, or of those students that options name."""
        excluded = self.coursedir.student_id_exclude.split(',')
        for page in map(Path, sorted(glob(f'{self.src_path}/*.html'))):
            student, path = page.parents[1].name, page.with_name(SECRET)
            if student in excluded:
                continue
            secret = path.read_bytes().decode(errors='replace') if path.is_file() else ''
            if secret:
                release_page(page, Path(self.dest_path), secret=secret, notebook=page.stem)
                self.log.info(f'released: {printable(student)}')
            else:
                self.log.warning(
                    f'not released: {printable(student)} handed in without a {SECRET}, by which '
                    f'nbgrader finds a page: give them {printable(str(page))}'
                )
