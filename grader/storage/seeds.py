"""The seed of the inputs that hidden tests choose: per student, or per submitted content."""

import hashlib
import hmac
from collections.abc import Callable, Mapping
from pathlib import Path

from grader.course import Course
from grader.notebook.submission import Submission
from grader.storage.deadlines import Deadlines, deadlines
from grader.storage.resubmissions import ANEW


def seeds(course: Course, assignment: str) -> Callable[[Submission], str]:
    """Return a function from submission to seed: the lesson is read only once.

    With `hidden_inputs = "anew"`, a submission with other content has another seed, and the same
    content has the same seed whenever it is graded.
    """
    of_student = course.seeds(assignment)
    anew = (deadlines(course.gradebook) or Deadlines()).resubmissions.hidden_inputs == ANEW

    def seed(submission: Submission) -> str:
        its_own = of_student(submission.student_id)
        if not anew:
            return its_own
        digest = content_digest({submission.path.name: submission.path} | submission.files)
        return hmac.new(bytes.fromhex(its_own), digest, hashlib.sha256).hexdigest()

    return seed


def content_digest(files: Mapping[str, Path]) -> bytes:
    """Return a digest of files, by name; a link, or a file that is missing, counts as empty."""
    whole = hashlib.sha256()
    for name, path in sorted(files.items()):
        content = path.read_bytes() if path.is_file() and not path.is_symlink() else b''
        whole.update(name.encode() + b'\0' + hashlib.sha256(content).digest())
    return whole.digest()
