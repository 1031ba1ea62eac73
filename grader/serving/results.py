"""Results of the resident process: stored, with their feedback released, and decided."""

import time
from concurrent.futures import Future
from dataclasses import replace

from grader.common.parsing import ParsingFailed
from grader.common.text import printable
from grader.grading import GradedSubmission, SubmissionOutcome
from grader.report.feedback import write_page
from grader.serving.exchange import release_page
from grader.serving.intake import remove_copies, secret_of
from grader.serving.queue import FAILED, GRADED, UNDECIDED, Arrival
from grader.serving.state import ServingState, folder_of, run
from grader.serving.unexpected_errors import affects_all_submissions, log_unexpected_error
from grader.storage.failures import raise_gradebook_errors

_UNDECIDED = 'a check could not decide'
_SAID = {
    GRADED: ('graded', ''),
    UNDECIDED: ('undecided', '; it is graded once more when there is time'),
    FAILED: ('undecided', ' and graded twice; ./course grade tries again'),
}
_REPLACED = f'{_UNDECIDED}, and a later one was graded'


def store_finished(serving: ServingState) -> bool:
    """Store finished gradings, write and release feedback; return whether there was any."""
    done = [work for work in serving.running if work.done()]
    for work in done:
        store_result(serving, serving.running.pop(work), work)
    return bool(done)


def store_result(
    serving: ServingState, arrival: Arrival, work: 'Future[GradedSubmission]'
) -> None:
    """Store one result; its feedback page is released before it counts as graded.

    If a check could not decide, it is graded once more; after that, it is left to a person.
    """
    outcome = serving.grading.store(folder_of(serving, arrival), work)
    name, again = arrival.printable_name, arrival.state == UNDECIDED
    if outcome.stored is None:  # of a second grading: the first result is still what is stored
        reason = outcome.reason.removeprefix('not graded, ')
        ended = replace(arrival, state=FAILED, reason=reason, ended=time.time())
        serving.say(f'not graded{" again" * again}: {name}: {printable(reason)}')
    else:
        unreleased = _release(serving, arrival)
        score, most = outcome.stored.score, outcome.stored.max_score
        ended = replace(
            arrival,
            state=_state_after(arrival, outcome),
            reason=_UNDECIDED if outcome.is_undecided else unreleased,
            ended=time.time(),
            score=score,
            max_score=most,
        )
        seconds = ended.ended - ended.arrived
        said, then = _SAID[ended.state]
        serving.say(f'{said}: {name}: {score:g} of {most:g}, {seconds:.1f} s after it came{then}')
        if unreleased:
            serving.say(printable(f'no feedback: {name}: {unreleased}'))
    _end(serving, ended)


def grade_undecided(serving: ServingState) -> bool:
    """Grade a submission again in which a check could not decide; return whether there was any."""
    found = serving.queue.find(UNDECIDED)
    for arrival in found[:1]:  # alone: others are what mostly keeps the machine busy
        run(serving, arrival)
    return bool(found)


def _state_after(arrival: Arrival, outcome: SubmissionOutcome) -> str:
    if not outcome.is_undecided:
        return GRADED
    return FAILED if arrival.state == UNDECIDED else UNDECIDED


def _end(serving: ServingState, ended: Arrival) -> None:
    """Record a result; an undecided one of the same lesson is not graded again after it."""
    earlier = [
        replace(each, state=GRADED, reason=_REPLACED)
        for each in serving.queue.find(UNDECIDED)
        if each.submission_key == ended.submission_key and each.number != ended.number
    ]
    serving.queue.update(ended, *earlier)
    # the copy of an undecided one has the secret of its feedback page
    remove_copies(serving.course, [*earlier, *([ended] if ended.state != UNDECIDED else [])])


def _release(serving: ServingState, arrival: Arrival) -> str:
    """Write a feedback page, and put it into the exchange; return why that failed, or ''."""
    try:
        with raise_gradebook_errors(serving.course):
            page, _ = write_page(serving.course, *arrival.submission_key, serving.exporter)
        if serving.feedback and (secret := secret_of(serving.course, arrival)):
            release_page(page, serving.feedback, secret=secret, notebook=arrival.assignment)
    except ParsingFailed as why:
        return f'no page can be made: {why}'
    except Exception as error:
        if affects_all_submissions(error):
            raise
        return f'no page can be made: {log_unexpected_error(arrival.printable_name, error)}'
    return ''
