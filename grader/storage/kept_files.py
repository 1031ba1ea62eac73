"""The submitted files, kept beside the executed notebook."""

import shutil

from my_robot_basics.session import package_files

from grader.common.files import write_whole
from grader.course import Course
from grader.notebook.submission import Submission, exchange_files


def keep_files(course: Course, submission: Submission) -> None:
    """Copy the submitted files to the folder of the executed notebook, before scores are stored.

    Raises OSError if that can't be done: then nothing is stored.
    """
    folder = course.folder('autograded', submission.student_id, submission.assignment)
    beside = (*submission.extra_files, *exchange_files(submission))
    files = {each.name: each.read_bytes() for each in beside}
    files |= {
        name: package_files.read_plain_file(f) for name, f in submission.package_files.items()
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name in course.packages(submission.assignment):
        shutil.rmtree(folder / name, ignore_errors=True)  # files of an earlier hand-in
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(folder / name, content)
