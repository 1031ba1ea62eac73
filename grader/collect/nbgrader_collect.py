"""`nbgrader collect`, and the formgrader's button for it: they collect as `./course collect` does.

nbgrader's own copies what a student's links lead to, with the instructor's rights: a link to a
hidden test would reach that student's room, and the feedback. It ends at a name or a named pipe
that it does not expect, and replaces a student's work by what anybody else has named after them.
"""

from pathlib import Path

from nbgrader.exchange.default import ExchangeCollect

from grader.collect.collect import collect
from grader.collect.collect_table import table_lines
from grader.common.db_url import gradebook_of
from grader.course import Course


class CollectAsWeDo(ExchangeCollect):
    """Takes in all lessons that the exchange has; nbgrader's options for this make no difference.

    `nbgrader_config.py` names it.
    """

    def init_src(self) -> None:
        """Find the exchange's folder. Raises ExchangeError if there is none."""
        self.inbound = Path(self.root, self.coursedir.course_id or '?', 'inbound')
        if not self.inbound.is_dir():
            self.fail(
                f'there is no folder {self.inbound}: name the course with --course, and the '
                'exchange with --Exchange.root'
            )

    def copy_files(self) -> None:
        """Collect, and log the table that `./course collect` prints."""
        root = Path(self.coursedir.root)
        course = Course(root=root, gradebook=gradebook_of(self.coursedir.db_url, root))
        for line in table_lines(collect(course, self.inbound), self.inbound):
            self.log.info(line)
