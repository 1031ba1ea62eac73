"""The report of one run for instructors: a page, and the same facts as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from functools import cache, partial
from pathlib import Path

from jinja2 import Template
from my_robot_basics.language.catalogues import ENGLISH, LOCALE, read_translations
from my_robot_basics.language.speaking import in_language
from my_robot_basics.validate.lessons.cells import title_of

from grader.common.files import make_folder_for, write_whole
from grader.common.text import printable
from grader.common.versions import versions
from grader.course import Course
from grader.export.totals import Totals, add_up
from grader.grading import SubmissionOutcome
from grader.kernels.isolation import require_isolation
from grader.report.charts import distribution, share_bar
from grader.report.message_groups import Reason
from grader.report.progress_table import changes, score_of
from grader.report.similar_answers import SimilarPair, find_similar
from grader.report.statistics import Tally, tally
from grader.report.templates import put_markup, template
from grader.storage.records import records

PART = 'report'
"""The name of the catalogue with the page's texts."""
SLOWEST = 10
MOST_SHOWN = 20
"""How many reasons the page shows; the JSON has all."""
HARDEST = 8
"""How many of the hardest checks are listed first; all are listed with their assignments."""


@dataclass(frozen=True)
class Run:
    """One call of `./course grade`."""

    began: datetime
    """With a time zone."""
    seed: str = ''
    """The seed that was replayed; '' if each student had a seed of their own."""


def write_report(
    course: Course, run: Run, rows: Sequence[SubmissionOutcome], *, language: str = ENGLISH
) -> Path:
    """Write report.html and report.json into gradebook/runs/<time>/; return the page's path.

    The page is in `language`; report.json, which is for programs, is in English.
    """
    stored = records(course)
    counted = tally(course, rows, stored)
    now = {row.assignment for row in rows if row.seconds is not None and row.stored}
    similar = find_similar(course, sorted(now))
    facts = _facts(run, rows, counted) | {
        'totals': _totals(add_up(stored)),
        'similar': [_similar(pair) for pair in similar.pairs],
        'not compared': similar.problems,
    }
    folder = make_folder_for(run.began, course.gradebook / 'runs')
    write_whole(folder / 'report.json', json.dumps(facts, indent=2, ensure_ascii=False) + '\n')
    page = folder / 'report.html'
    write_whole(
        page,
        _template(language).render(
            facts,
            titles=_titles(course, counted, language),
            tally=counted,
            most=MOST_SHOWN,
            hardest=HARDEST,
            similar_answers=similar,
        ),
    )
    return page


def _facts(run: Run, rows: Sequence[SubmissionOutcome], counted: Tally) -> dict:
    """Return all facts of the report as plain values."""
    seconds = (datetime.now().astimezone() - run.began).total_seconds()
    timed = [row for row in rows if row.seconds is not None]
    return {
        'began': run.began.isoformat(timespec='seconds'),
        'seconds': round(seconds, 1),
        'counts': {
            'submissions': len(rows),
            'graded now': len(timed),
            'unchanged': sum(row.reused for row in rows),
            'wait for a person': sum(bool(row.stored and row.stored.pending) for row in rows),
            'could not be graded': sum(row.stored is None for row in rows),
        },
        'per_minute': round(60 * len(timed) / seconds, 1) if seconds else None,
        'looks': [_reason(each) for each in counted.looks],
        'changes': changes(rows),
        'assignments': [
            asdict(each) | {'mean': each.mean, 'median': each.median}
            for each in counted.assignments
        ],
        'reasons': [_reason(each) for each in counted.reasons],
        'slowest': [
            _submission(row)
            for row in sorted(timed, key=lambda row: -(row.seconds or 0.0))[:SLOWEST]
        ],
        'environment': versions()
        | {
            'isolation': 'each submission in a sandbox'
            if require_isolation(trust_students=True)
            else 'none: --trust-students',
            'inputs of hidden tests': f'replayed from seed {run.seed}'
            if run.seed
            else "each student's own",
        },
        'submissions': [_submission(row) for row in rows],
    }


def _titles(course: Course, counted: Tally, language: str) -> dict[str, str]:
    """Return the titles of lessons in the language of the report."""
    titles = {each.name: f'# {title_of(course.source(each.name))}' for each in counted.assignments}
    for name, title in titles.items():
        known = read_translations(LOCALE, language, name)
        titles[name] = known.get(title, title).removeprefix('# ')
    return titles


def _totals(totals: Totals) -> dict:
    return {
        'max_scores': dict(zip(totals.assignments, totals.max_scores, strict=True)),
        'max_score': totals.max_score,
        'students': [
            {
                'student_id': printable(each.student_id),
                'scores': each.scores,
                'total': each.total,
                'waiting': each.waiting,
            }
            for each in totals.students
        ],
    }


def _similar(pair: SimilarPair) -> dict:
    return {
        'assignment': pair.assignment,
        'exercise': pair.exercise,
        'students': [printable(student) for student in pair.students],
        'share': round(pair.share, 2),
    }


def _reason(reason: Reason) -> dict:
    return asdict(reason) | {'count': len(reason.students)}


def _submission(row: SubmissionOutcome) -> dict:
    return {
        'student_id': printable(row.student_id),
        'assignment': printable(row.assignment),
        'points': score_of(row),
        'score': row.stored.score if row.stored else None,
        'max_score': row.stored.max_score if row.stored else None,
        'former': row.stored.former if row.stored else None,
        'unchanged': row.reused,
        'seconds': None if row.seconds is None else round(row.seconds, 2),
        'reason': printable(row.reason),
    }


@cache
def _template(language: str) -> Template:
    put = partial(put_markup, read_translations(LOCALE, language, PART))
    return template(
        'report.html.j2',
        filters={'said': partial(in_language, language)},
        values={
            '_': put,
            'language_code': language.replace('_', '-'),
            'distribution': partial(distribution, put=put),
            'share': share_bar,
        },
    )
