"""The work and output of `./course serve`: grade what is handed in, until it is ended."""

import argparse
from datetime import datetime

from grader.collect.collect import refuse_the_course
from grader.common.errors import CourseError
from grader.course import Course
from grader.serving.exchange import feedback_folder
from grader.serving.queue_file import open_queue_to_read
from grader.serving.serve import serve
from grader.serving.status import status_lines, write_status_page
from grader.workers.workers import Workers

_INBOUND = (
    "into which submissions are put, nbgrader's /srv/nbgrader/exchange/COURSE/inbound for instance"
)


def run_serve(course: Course, asked: argparse.Namespace) -> int:
    """Serve a folder until SIGINT or SIGTERM, or print the state of the process that does."""
    if asked.status:
        with open_queue_to_read(course.gradebook) as queue:
            for line in status_lines(course, queue):
                print(line)
        return 0
    if asked.folder is None:
        raise CourseError(
            f'name the folder {_INBOUND}: ./course serve FOLDER. What waits there, and what is '
            'done: ./course serve --status'
        )
    if not asked.folder.is_dir():
        raise CourseError(f'{asked.folder} is no folder: expected the one {_INBOUND}')
    refuse_the_course(course, asked.folder.resolve())
    feedback = feedback_folder(asked.folder)
    _say(f'serving {asked.folder}' + (f', feedback goes to {feedback}' if feedback else ''))
    try:
        serve(
            course,
            asked.folder,
            backend=Workers(asked.workers) if asked.workers else Workers(),
            feedback=feedback,
            trust_students=asked.trust_students,
            once=asked.once,
            say=_say,
            changed=lambda queue: write_status_page(course, queue),
        )
    except KeyboardInterrupt:
        _say('stopped: what was not done is done by the next ./course serve')
    return 0


def _say(line: str) -> None:
    print(f'{datetime.now():%Y-%m-%d %H:%M:%S} {line}', flush=True)
