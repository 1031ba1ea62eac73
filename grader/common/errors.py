"""Errors of grading, in sentences for the instructor."""

import errno

from my_robot_basics.validate.errors import CourseError as CourseError
from my_robot_basics.validate.errors import RoomFailure as RoomFailure

DISK_FULL = (errno.ENOSPC, errno.EDQUOT)
"""Error numbers of a full disk, or of a quota that is used up."""
MACHINE_FULL = (*DISK_FULL, errno.EMFILE, errno.ENFILE)
"""The same, and those for too many open files: none is the fault of the file that is read."""


class GradebookError(CourseError):
    """The gradebook can't be written to: grading stops until that is fixed."""


class UnreadableSubmission(CourseError):
    """The submitted file can't be graded: it gets zero, with this text as the reason."""


class DamagedResult(CourseError):
    """A graded notebook is damaged: grade the submission again."""


class TaskFailed(CourseError):
    """A submission has no result: it is not graded; others are not affected."""

    def __init__(self, why: str, trace: str = '') -> None:
        """Take the reason, and a traceback for the log."""
        super().__init__(why)
        self.trace = trace


class SubmissionChanged(CourseError):
    """The files of a submission are not those that were judged: its result is not stored."""


class ClusterError(CourseError):
    """The machines that grade are not usable, or gone: the run ends, and can go on later."""
