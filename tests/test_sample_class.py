"""The sample class: each notebook gets its expected verdicts in the grader and in Validate."""

import re
import tempfile
from functools import cache
from pathlib import Path

import nbformat
import pytest
from answered import read
from changed_packages import ALL
from package_changes import FULL, LESSON, write
from sample_class import EXPECTED, PATHS, assignment_of, grade, package_of, rebased
from stock_validator import validators

from grader.course import Course
from grader.judging.execute import execute
from grader.notebook.restore import make_template, restore
from grader.storage.records import verdicts
from grader.workers.workers import Workers

NO_VERDICT = {
    '03_publisher-fail-os_exit': 'Kernel died',
    '03_publisher-pass-repeated_grade_cells': 'metadata may be corrupted',
    '03_publisher-pass-split_answer': 'metadata may be corrupted',
    '03_publisher-zero-not_json': 'NotJSONError',
}
"""Notebooks on which stock Validate breaks, and what it says."""
CHANGED = (
    '03_publisher-fail-edited_grade_cells',
    '03_publisher-fail-skip_execution_tags',
)
"""Notebooks whose grade cells stock Validate finds changed: it reports nothing else then."""
ABSENT = {
    '03_publisher-pass-deleted_grade_cells',
    '03_publisher-zero-another_assignment',
}
"""Notebooks without the assignment's grade cells: stock Validate cannot judge them."""
TRUSTS = {
    '03_publisher-fail-makes_the_courses_node_later',
    '03_publisher-fail-patches_everything',
}
"""Notebooks that fool a check which runs in their own kernel, as Validate's do."""
OUT_OF_ORDER = {'02_joint_state-pass-helper_in_the_last_cell': "name 'to_rad' is not defined"}
"""Notebooks that do not run from top to bottom, as Validate runs them; the grader lets them."""
BESIDE_THE_ARM = {
    '07_common_errors-fail-one_message_late',
    '07_common_errors-fail-right_only_at_first_or_beside',
}
"""Notebooks whose relay waits for another message: the lesson's Arm, which the cell before the
check runs, sends one soon. Our Validate and the grader run no such cell."""
RELAY = 'fix_topic_name-fixed'
WAITS_ALREADY = {
    '08_services-fail-call_in_the_callback',
    '08_services-fail-call_with_a_timeout',
    '08_services-fail-lets_the_error_out',
    '08_services-fail-sleeps_in_the_callback',
    '08_services-fail-spins_in_the_callback',
    '09_actions-fail-waits_in_the_callback',
}
"""Notebooks whose client waits in a callback: in the lesson's one kernel, where cells ran before
the checks, it may still be waiting, and the reason differs."""


def of_assignment(assignment):
    return [name for name, path in PATHS.items() if assignment_of(path) == assignment]


def tells(name, new):
    """Return a sort key: samples that fail many new checks last, untouched ones before them."""
    return (new > 0, not name.endswith('-untouched'), new)


def most_telling():
    """Return few samples of which at least one fails each check."""
    telling = set()
    for assignment in {assignment_of(path) for path in PATHS.values()}:
        names = of_assignment(assignment)
        failed = {
            name: {grade_id for grade_id, (score, *_) in EXPECTED[name].items() if score == 0.0}
            for name in names
        }
        left = set().union(*failed.values())
        while left:
            most = max(failed, key=lambda name: tells(name, len(failed[name] & left)))
            telling.add(most)
            left -= failed[most]
    return telling


BROKEN = {
    '03_publisher-fail-raises_so_nothing_defined': 'your cell `five_hz` stopped with Zero',
    '03_publisher-fail-imported_class': 'your cell `five_hz-run` stopped with NotRunnable',
    '03_publisher-zero-another_assignment': 'the notebook holds none of the answer cells',
}
"""Samples with a cell that can't run, and how their rows begin."""
WITH_DEMOS = {'02_joint_state-pass-numpy', '03_publisher-pass-sleep_loop'}
"""Samples that Validate runs as a whole; the others are run without the demonstrations."""
RIGHT = {'03_publisher-pass-deleted_grade_cells'}
AT_ONCE = {'03_publisher-fail-callback_raises'}
"""Samples that go through Validate in an ordinary run; `./course test --slow` takes all."""
ORDINARY = {*AT_ONCE, *BROKEN, *RIGHT, *most_telling()}
"""Samples that an ordinary run grades."""


def sooner(names, these):
    """Mark all names but these as slow."""
    slow = pytest.mark.slow
    return [pytest.param(name, marks=[] if name in these else [slow], id=name) for name in names]


class Standing:
    """A backend that is there for several runs: starting a new one each time would take long."""

    def __init__(self, backend):
        self.capacity, self.submit = backend.capacity, backend.submit
        self.require_isolation, self.begin = backend.require_isolation, backend.begin

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        pass


@pytest.fixture(scope='module')
def graded(tmp_path_factory):
    """Gives, for a sample, the gradebook of its assignment's class, and the row that it got."""

    @cache
    def grade_class(assignment, ordinary):
        names = [name for name in of_assignment(assignment) if (name in ORDINARY) == ordinary]
        course = Course(gradebook=tmp_path_factory.mktemp('gradebook'))
        return course, grade(course, names, backend=backend)

    def graded_sample(name):
        course, rows = grade_class(assignment_of(PATHS[name]), name in ORDINARY)
        return course, rows[name]

    # other tests run meanwhile
    with Workers(in_flight=4) as workers:
        backend = Standing(workers)
        yield graded_sample


@pytest.fixture(scope='module')
def validated(tmp_path_factory):
    """Gives what nbgrader's Validate says of a sample."""
    folder = tmp_path_factory.mktemp('validated')

    def as_validated(name):
        if name in WITH_DEMOS:
            return PATHS[name]
        shorter = folder / name / PATHS[name].name
        shorter.parent.mkdir()
        write(package_of(name), shorter.parent)
        shorter.write_text(rebased(PATHS[name], with_demos=False), encoding='utf-8')
        return shorter

    @cache
    def validate_class(assignment, at_once):
        names = [name for name in of_assignment(assignment) if (name in AT_ONCE) == at_once]
        return validate_all(map(as_validated, names))

    with validators() as validate_all:
        yield lambda name: validate_class(assignment_of(PATHS[name]), name in AT_ONCE)[name]


def test_every_sample_has_expected_scores():
    assert set(EXPECTED) == set(PATHS)


def test_each_sample_has_an_expected_score_for_each_check_of_its_lesson():
    for name, path in PATHS.items():
        lesson = assignment_of(path)
        marks = [cell.metadata.get('nbgrader', {}) for cell in read('notebooks', lesson).cells]
        checks = {mark['grade_id'] for mark in marks if mark.get('grade')}
        assert {*EXPECTED[name]} == checks, f'{name} in tests/submissions/expected/{lesson}.json'


def test_a_sample_with_a_package_earns_the_points_of_that_package():
    packages = {change.name: change.points for change in ALL}
    names = [name for name in of_assignment(LESSON) if package_of(name)]
    assert len(names) >= 5
    for name in names:
        earned = tuple(score for score, *_ in EXPECTED[name].values())
        assert earned == packages[name.split('-', 2)[2]]
        assert ('-pass-' in name) == (earned == FULL)


@pytest.mark.parametrize('name', PATHS)
def test_a_sample_is_based_on_the_present_release(name):
    assert PATHS[name].read_text(encoding='utf-8') == rebased(PATHS[name])


def test_an_ordinary_run_grades_right_samples_and_some_that_fail_each_check():
    checks = {grade_id for cells in EXPECTED.values() for grade_id in cells}
    zeros = {
        each for name in ORDINARY for each, (score, *_) in EXPECTED[name].items() if score == 0
    }
    assert checks - {'explain_counts'} - zeros == set()
    assert set(EXPECTED) > ORDINARY > RIGHT


@pytest.mark.starts
@pytest.mark.parametrize('name', sooner(EXPECTED, ORDINARY))
def test_a_sample_earns_its_expected_points_for_the_expected_reasons(graded, name):
    cells = EXPECTED[name]
    course, row = graded(name)
    found = verdicts(course, name, assignment_of(PATHS[name]))
    points = 0.0
    for grade_id, (score, *words) in cells.items():
        if score is None:  # a person gives it
            assert 'outcome' not in found[grade_id]
            continue
        said = ' | '.join([found[grade_id].reason, *found[grade_id].notes])
        wanted = 'partial' if words and score else 'failed' if words else 'passed'
        assert found[grade_id].outcome == wanted, said
        assert [word for word in words if word not in said] == [], said
        points += score
    assert row.stored.score == points
    assert row.stored.pending == ([None] in cells.values())
    assert bool(row.reason) == ('-pass-' not in name)


@pytest.mark.starts
def test_the_row_of_a_broken_cell_names_the_cause_first(graded):
    for name, cause in BROKEN.items():
        assert graded(name)[1].reason.startswith(cause)


@pytest.mark.starts
@pytest.mark.parametrize(
    'name', sooner([name for name in PATHS if name not in (*NO_VERDICT, *CHANGED)], AT_ONCE)
)
def test_validate_says_the_same_as_the_grader_of_each_visible_cell(graded, validated, name):
    course, _ = graded(name)
    notebook = nbformat.read(PATHS[name], as_version=4)
    ours = {
        grade_id: verdict.reason
        for grade_id, verdict in verdicts(course, name, assignment_of(PATHS[name])).items()
        if 'outcome' in verdict and verdict.get('role') != 'answer'  # Validate reads no text
    }
    theirs = by_cell(notebook, validated(name), name)
    if name in ABSENT:
        assert not theirs.keys() & ours.keys()
    elif name in TRUSTS:
        assert all(ours.values())
        assert not any(theirs.values())
    elif name in OUT_OF_ORDER:
        assert not any(ours.values())
        assert all(OUT_OF_ORDER[name] in ' '.join(said.split()) for said in theirs.values())
    else:
        # the visible part comes first in its cell: a failure there has the same reason here
        if numberless(ours) != numberless(theirs):
            ours = visible_parts_alone(notebook, name)
        if name in BESIDE_THE_ARM:
            assert ours.pop(RELAY) != theirs.pop(RELAY)
        # only JupyterLab tells a kernel which notebook it runs, and so what its cells held
        if name in WAITS_ALREADY or name.endswith('-untouched'):
            assert failing(ours) == failing(theirs)
        else:
            assert numberless(ours) == numberless(theirs)


@pytest.mark.slow  # that says how far stock Validate goes
@pytest.mark.parametrize(('name', 'why'), NO_VERDICT.items(), ids=NO_VERDICT)
def test_stock_validate_gives_no_verdict_on_a_sample_that_breaks_it(validated, name, why):
    assert why in validated(name)['broken']


@pytest.mark.slow
@pytest.mark.parametrize('name', CHANGED)
def test_stock_validate_reports_changed_grade_cells(validated, name):
    changed = [cell['source'] for cell in validated(name)['changed']]
    notebook = nbformat.read(PATHS[name], as_version=4)
    assert {c.id for c in notebook.cells if c.source.strip() in changed} == set(EXPECTED[name])


def by_cell(notebook, found, name):
    """What Validate says of each grade cell: its error, or '' if it passed."""
    assert found.keys() <= {'failed'}, (name, found)
    # Validate shows the same words in lines of their own
    errors = {c['source']: c['raw_error'].replace('\n', ' ') for c in found.get('failed', [])}
    return {
        cell.metadata.nbgrader.grade_id: errors.get(cell.source.strip(), '')
        for cell in notebook.cells
        if cell.metadata.get('nbgrader', {}).get('grade') and cell.cell_type == 'code'
    }


def visible_parts_alone(notebook, name):
    """What the grader says of each grade cell as students see it."""
    release = Course().release(assignment_of(PATHS[name]))
    restored = restore(notebook, make_template(release, release)).notebook
    with tempfile.TemporaryDirectory() as folder:
        write(package_of(name), Path(folder))
        execution = execute(restored, extra_files=[*Path(folder).iterdir()])
    return {v.grade_id: v.reason for v in execution.verdicts if v.outcome != 'manual'}


def failing(reasons):
    return {name for name, reason in reasons.items() if reason}


def numberless(reasons):
    """Reasons by cell, in one line and without numbers: poses are random, rates are measured.

    The time that a check waited is left out, and so is whether it waited: it does not where no
    thread or process could still make an endpoint, and a whole lesson in one kernel has some.
    """
    waited = re.compile(r' in \d+(\.\d+)? s\b')
    number = re.compile(r'-?\d+(\.\d+)?(e-?\d+)?')
    lines = {name: waited.sub('', ' '.join(reason.split())) for name, reason in reasons.items()}
    return {name: number.sub('#', line) for name, line in lines.items()}
