"""What can go wrong while grading, in sentences for the instructor."""

import errno

from my_robot_basics.validate.errors import CourseError as CourseError
from my_robot_basics.validate.errors import RoomFailure as RoomFailure

DISK_FULL = (errno.ENOSPC, errno.EDQUOT)
"""What Linux says of a disk that takes no more …"""
MACHINE_FULL = (*DISK_FULL, errno.EMFILE, errno.ENFILE)
"""… and where no more files can be open either: it is not the fault of what was to be read."""


class GradebookError(CourseError):
    """The gradebook can't be written to: nothing more is graded before that is fixed."""


class UnreadableSubmission(CourseError):
    """The submitted file can't be graded: it gets zero, and this text as the reason."""


class DamagedResult(CourseError):
    """A graded notebook is no longer one: grading makes it anew."""


class TaskFailed(CourseError):
    """A submission came to no result: it is not graded, and the next one may be."""

    def __init__(self, why: str, trace: str = '') -> None:
        """Say why, and where in the code, for the log."""
        super().__init__(why)
        self.trace = trace


class ClusterError(CourseError):
    """The machines that grade can't be used, or are gone: the run ends, and can go on later."""
