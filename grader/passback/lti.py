"""Send scores to a learning platform by LTI 1.3; those that it does not take are sent again."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from grader.common.errors import CourseError
from grader.course import Course
from grader.passback.final_scores import final_scores
from grader.passback.lti_platform import CONFLICT, LtiService, PlatformIsAway, ScoreRefused
from grader.passback.lti_queue import LtiQueue, Score, opened_lti_queue
from grader.passback.lti_settings import FILE, LtiSettings, read_settings
from grader.storage.lock import gradebook_lock
from grader.storage.records import CellScore, records


@dataclass(frozen=True)
class LtiOutcome:
    """The result of sending scores."""

    sent: int
    waiting: int
    """How many scores the platform does not have yet."""


def send_scores(course: Course, assignment: str, say: Callable[[str], None]) -> LtiOutcome:
    """Send each final score that the platform does not have, of an assignment or of all.

    `say` gets a line for each student whose score is not sent, with the reason. Raises CourseError
    if gradebook/lti.toml is wrong, if there is no such assignment, or if nothing of it is graded.
    """
    settings = read_settings(course)
    platform = LtiService(settings)
    found = records(course)
    if assignment and not final_scores(found, assignment):
        course.expect_assignment(assignment)
    with gradebook_lock(course.gradebook, say), opened_lti_queue(course.gradebook) as queue:
        queue.note(_to_be_sent(found, assignment, settings, say))
        return _send_waiting(queue, platform, assignment, say)


def _to_be_sent(
    found: list[CellScore], assignment: str, settings: LtiSettings, say: Callable[[str], None]
) -> list[Score]:
    """Return the final scores of students who have an id on the platform."""
    now, scores = time.time(), []
    graded = final_scores(found, assignment)
    if assignment and not graded:
        raise CourseError(
            f'nothing of {assignment} is graded yet: first ./course collect, then ./course grade'
        )
    for of_one in graded:
        for student in of_one.waiting:
            say(f'{of_one.assignment}: {student} needs manual grading in the formgrader')
        for each in of_one.final:
            if user := settings.user_id_of(each.student_id):
                names = each.student_id, of_one.assignment, user
                scores.append(Score(*names, each.score, each.max_score, now))
            else:
                say(f'{of_one.assignment}: {each.student_id} is not in [user_ids] of {FILE}')
    return scores


def _send_waiting(
    queue: LtiQueue, platform: LtiService, assignment: str, say: Callable[[str], None]
) -> LtiOutcome:
    sent = 0
    for score in queue.waiting(assignment):
        queue.note_try(score)
        try:
            platform.send(score)
        except PlatformIsAway as problem:
            queue.note_problem(score, str(problem), answered=False)
            say(
                f'the platform did not answer as expected: {problem}. Fix it, then run this again.'
            )
            break
        except ScoreRefused as problem:
            # 409 after an earlier try: the platform has it; its answer was lost or not waited for
            if not (problem.status == CONFLICT and score.tried):
                queue.note_problem(score, str(problem), answered=True)
                say(f'{score.assignment}: {score.student_id}: the score was refused: {problem}')
                continue
        queue.note_sent(score)
        sent += 1
    return LtiOutcome(sent, len(queue.waiting(assignment)))
