"""What can go wrong while grading, in sentences for the instructor."""


class CourseError(Exception):
    """Say what happened, what was expected and what to do next; shown without a traceback."""


class GradebookError(CourseError):
    """The gradebook can't be written to: nothing more is graded before that is mended."""


class UnreadableSubmission(CourseError):
    """The submitted file can't be graded: it gets zero, and this text as the reason."""


class RoomFailure(CourseError):
    """The grader itself failed: never the student's fault, never a zero."""


class TaskFailed(CourseError):
    """A submission came to no result: it is not graded, and the next one may be."""

    def __init__(self, why: str, trace: str = '') -> None:
        """Say why, and where in the code, for the log."""
        super().__init__(why)
        self.trace = trace


class ClusterError(CourseError):
    """The machines that grade can't be used, or are gone: the run ends, and can go on later."""
