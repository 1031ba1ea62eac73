"""Results of the resident process: stored, with their feedback released, and decided."""

import time
from concurrent.futures import Future
from dataclasses import replace

from grader.common.parsing import ParsingFailed
from grader.common.text import printable
from grader.grading import GradedSubmission
from grader.report.feedback import write_page
from grader.serving.exchange import release_page
from grader.serving.intake import remove_copies, secret_of
from grader.serving.queue import FAILED, GRADED, Arrival
from grader.serving.state import ServingState, folder_of, run
from grader.serving.unexpected_errors import affects_all_submissions, log_unexpected_error
from grader.storage.failures import raise_gradebook_errors

_UNDECIDED = 'a check could not decide: ./course grade grades it again'


def store_finished(serving: ServingState) -> bool:
    """Store finished gradings, write and release feedback; return whether there was any."""
    done = [work for work in serving.running if work.done()]
    for work in done:
        store_result(serving, serving.running.pop(work), work)
    return bool(done)


def store_result(
    serving: ServingState, arrival: Arrival, work: 'Future[GradedSubmission]'
) -> None:
    """Store one result; its feedback page is released before it counts as graded."""
    outcome = serving.grading.store(folder_of(serving, arrival), work)
    name, now = arrival.printable_name, time.time()
    replaced = serving.undecided.pop(arrival.submission_key, None)
    if outcome.stored is None:
        ended = replace(arrival, state=FAILED, reason=outcome.reason, ended=now)
        serving.say(f'not graded: {name}: {printable(ended.reason)}')
    else:
        unreleased = _release(serving, arrival)
        reason = unreleased or _UNDECIDED * outcome.is_undecided
        score, most = outcome.stored.score, outcome.stored.max_score
        ended = replace(
            arrival, state=GRADED, reason=reason, ended=time.time(), score=score, max_score=most
        )
        seconds = ended.ended - ended.arrived
        serving.say(f'graded: {name}: {score:g} of {most:g}, {seconds:.1f} s after it came')
        if unreleased:
            serving.say(printable(f'no feedback: {name}: {unreleased}'))
    serving.queue.update(ended)
    if outcome.is_undecided and arrival.state != GRADED:
        serving.undecided[arrival.submission_key] = ended  # its copy holds the secret of its page
    else:
        remove_copies(serving.course, [ended])
        if outcome.is_undecided:
            serving.say(f'not decided: {name}: {_UNDECIDED}')
    if replaced:
        remove_copies(serving.course, [replaced])


def grade_undecided(serving: ServingState) -> bool:
    """Grade a submission again in which a check could not decide; return whether there was any.

    Its row stays `graded`: if this is interrupted, its result is the first one.
    """
    if not serving.undecided:
        return False
    run(serving, serving.undecided.pop(next(iter(serving.undecided))))
    return True


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
