"""What can go wrong while grading, in sentences for the instructor."""


class CourseError(Exception):
    """Say what happened, what was expected and what to do next; shown without a traceback."""


class GradebookError(CourseError):
    """The gradebook can't be written to: nothing more is graded before that is mended."""


class UnreadableSubmission(CourseError):
    """The submitted file can't be graded: it gets zero, and this text as the reason."""


class RoomFailure(CourseError):
    """The grader itself failed: never the student's fault, never a zero."""
