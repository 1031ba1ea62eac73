"""What can go wrong beside an answer, in sentences for people."""


class CourseError(Exception):
    """Say what happened, what was expected and what to do next; shown without a traceback."""


class RoomFailure(CourseError):
    """What runs the checks failed itself: never the student's fault, never a zero."""
