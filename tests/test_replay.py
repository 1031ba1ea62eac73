import shutil

import pytest
from course_maker import TOY, answered, executed, released_course, submit, toy_lesson, write_source
from stand_in import stand_in

from grader.__main__ import main
from grader.judging.execute import Execution, execute
from grader.notebook.restore import KEY

ANSWER = 'def double(x):\n    return 2 * x'


@pytest.fixture(scope='module')
def graded(tmp_path_factory):
    """A course in which ada's answer is right for half of the inputs, and eve's can't be read."""
    with pytest.MonkeyPatch.context() as patch:
        course = released_course(tmp_path_factory.mktemp('replay'))
        stand_in(chosen_inputs, patch)
        submit(course, 'ada', answered(course, ANSWER))
        submit(course, 'eve', b'no notebook')
        assert main(['grade'], course=course) == 0
        yield course


async def chosen_inputs(notebook, *, extra_files=(), seed='', trust_students=False):
    """Stand in for the rooms: the hidden check passes or fails by the seed's last digit."""
    reason = '' if int(seed, 16) % 2 else 'expected 42, saw 41: count again'
    notebook = executed(notebook, {'double-hidden': reason})
    notebook.metadata[KEY]['seed'] = seed
    return Execution(notebook=notebook, verdicts=(), notes=())


def everything(course):
    return {path: path.read_bytes() for path in course.gradebook.rglob('*') if path.is_file()}


def replayed(course, capsys, *options):
    before = everything(course)
    status = main(['grade', *options], course=course)
    assert everything(course) == before
    return status, capsys.readouterr().out.splitlines()


def test_a_recorded_grade_is_replayed_and_compared_and_nothing_is_written(graded, capsys):
    status, lines = replayed(graded, capsys, '--student', 'ada', '--seed', 'recorded')
    assert lines[0] == f'ada  {TOY}  seed {graded.seed(TOY, "ada")}'
    assert lines[1] == '  double-check  passed  as stored'
    assert lines[-2:] == [
        'The same as in the gradebook.',
        'Nothing was stored.',
    ]
    assert status == 0


def test_a_replay_with_another_seed_reports_differing_verdicts(graded, capsys):
    other = f'{int(graded.seed(TOY, "ada"), 16) ^ 1:x}'
    status, lines = replayed(graded, capsys, '--student', 'ada', '--seed', other)
    assert lines[0].endswith(f'seed {other}')
    assert lines[1] == '  (this seed is not the one that grading uses)'
    assert lines[2] == '  double-check  passed  as stored'
    assert 'expected 42, saw 41' in lines[3]
    assert '  STORED: ' in lines[3]
    assert lines[4] == 'NOT the same as in the gradebook.'
    assert lines[5] == 'Nothing was stored; --store stores it.'
    assert status == 1


def test_an_unreadable_submission_is_replayed_as_stored(graded, capsys):
    status, lines = replayed(graded, capsys, '--student', 'eve', '--seed', 'recorded')
    assert status == 0
    assert all(line.endswith('as stored') for line in lines[1:3])


def test_the_recorded_seed_is_replayed_after_a_change_of_the_lesson(graded, capsys):
    former = graded.seed(TOY, 'ada')
    lesson = toy_lesson()
    lesson.cells[0].source += ' '
    write_source(graded, lesson)
    try:
        assert graded.seed(TOY, 'ada') != former
        _, lines = replayed(graded, capsys, '--student', 'ada', '--seed', 'recorded')
    finally:
        write_source(graded, toy_lesson())
    assert lines[0] == f'ada  {TOY}  seed {former}'
    assert 'the lesson was changed since' in lines[1]


def test_a_recorded_seed_needs_a_graded_submission_and_is_not_stored_again(graded, capsys):
    submit(graded, 'zoe', answered(graded, ANSWER))
    try:
        assert main(['grade', '--student', 'zoe', '--seed', 'recorded'], course=graded) == 1
        assert 'no seed is recorded' in capsys.readouterr().err
    finally:
        shutil.rmtree(graded.folder('submitted', 'zoe', ''))
    assert main(['grade', '--seed', 'recorded', '--store'], course=graded) == 1
    assert 'scores with recorded seeds are stored already' in capsys.readouterr().err


def test_the_option_store_needs_a_seed(graded, capsys):
    before = everything(graded)
    assert main(['grade', '--store'], course=graded) == 1
    assert '--store needs --seed HEX: ./course grade alone stores' in capsys.readouterr().err
    assert everything(graded) == before


def test_a_replay_with_the_option_store_stores_its_scores_and_seed(graded, capsys):
    other = f'{int(graded.seed(TOY, "ada"), 16) ^ 1:x}'
    before = everything(graded)
    assert main(['grade', '--student', 'ada', '--seed', other, '--store'], course=graded) == 0
    assert everything(graded) != before
    capsys.readouterr()
    _, lines = replayed(graded, capsys, '--student', 'ada', '--seed', 'recorded')
    assert lines[0].endswith(f'seed {other}')


def test_neither_feedback_nor_scores_contain_the_seed(graded):
    assert main(['feedback'], course=graded) == 0
    assert main(['scores'], course=graded) == 0
    kept = graded.folder('autograded', 'ada', TOY) / f'{TOY}.ipynb'
    assert '"seed": ' in kept.read_text()
    told = [*graded.folder('feedback', '', '').rglob('*.html'), graded.gradebook / 'scores.csv']
    seed = graded.seed(TOY, 'ada')
    assert len(told) == 3
    assert not [path for path in told if seed[:-1] in path.read_text()]


def test_execution_records_the_given_seed_in_the_notebook(graded):
    notebook = graded.source(TOY)
    notebook.metadata[KEY] = {'notes': [], 'problem': 'that nothing has to be run'}
    assert execute(notebook, seed='abc').notebook.metadata[KEY].seed == 'abc'
