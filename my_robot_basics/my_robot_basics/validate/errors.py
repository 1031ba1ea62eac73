"""Errors that are not a verdict about an answer, as sentences for people."""


class CourseError(Exception):
    """Base of errors that are shown without a traceback: what happened, and what to do next."""


class RoomFailure(CourseError):
    """Running the checks failed for another reason than the answer: it never gives a zero."""
