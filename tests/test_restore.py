"""Restoring: however a notebook was changed, it gets its source's cells and keeps answers."""

import nbformat
import pytest
from course_maker import TOY, answered, released_course
from hypothesis import given, settings
from hypothesis import strategies as st
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from grader.notebook.restore import KEY, grade_id, make_template, restore, role

ANSWER = 'def double(x):\n    return 2 * x'
ANSWERS = ('double', 'explain')
KEPT = ('grade', 'locked', 'setup')
"""Roles of cells whose text is always that of the template."""


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('course'))


@pytest.fixture(scope='module')
def template(course):
    return course.template(TOY)


@pytest.fixture
def submitted(course):
    return answered(course, ANSWER, explained='Because.')


def at(notebook, name):
    return next(i for i, c in enumerate(notebook.cells) if c.id == name)


def by_grade_id(notebook):
    found = [c for c in notebook.cells if grade_id(c)]
    assert len({grade_id(c) for c in found}) == len(found)
    return {grade_id(c): c for c in found}


def assert_whole(restored, template):
    """Assert that each template cell is there once, in order, with its text if that is kept."""
    names = [grade_id(c) for c in template.notebook.cells if grade_id(c)]
    assert [grade_id(c) for c in restored.notebook.cells if grade_id(c)] == names
    cells = by_grade_id(restored.notebook)
    for original in template.notebook.cells:
        if role(original) in KEPT and grade_id(original):
            cell = cells[grade_id(original)]
            assert cell == original | {'id': cell.id}
        elif role(original) == 'answer':
            cell = cells[grade_id(original)]
            assert (cell.cell_type, cell.metadata) == (original.cell_type, original.metadata)
    kept = [c.source for c in template.notebook.cells if role(c) in (*KEPT, 'text')]
    texts = iter([c.source for c in restored.notebook.cells if role(c) in (*KEPT, 'text')])
    assert all(source in texts for source in kept)  # in this order
    nbformat.validate(nbformat.from_dict(restored.notebook))


def test_an_untouched_submission_needs_no_restoring(submitted, template):
    restored = restore(submitted, template)
    assert_whole(restored, template)
    assert restored.notes == ()
    assert [c.id for c in restored.notebook.cells] == [c.id for c in submitted.cells]
    assert by_grade_id(restored.notebook)['double'].source == ANSWER
    assert by_grade_id(restored.notebook)['explain'].source == 'Because.'


def test_roles_of_cells_come_from_their_metadata_and_position(template):
    assert {c.id: role(c) for c in template.notebook.cells} == {
        'title': 'text',
        'setup': 'setup',
        'shown': 'demo',
        'double-reset': 'locked',
        'double': 'answer',
        'try-it': 'free',
        'double-check': 'grade',
        'double-hidden': 'grade',
        'explain': 'answer',
    }


def test_a_template_holds_the_hidden_tests_and_no_answer(template):
    text = nbformat.writes(template.notebook)
    assert 'hidden canary' in text
    assert 'the secret answer' not in text


def delete(name):
    def mutate(cells, i):
        del cells[i(name)]

    return mutate


def edit(name, source):
    def mutate(cells, i):
        cells[i(name)].source = source

    return mutate


def duplicate(name, **changes):
    def mutate(cells, i):
        cells.insert(i(name) + 1, nbformat.from_dict(cells[i(name)] | {'id': 'copy'} | changes))

    return mutate


def retype(name, new):
    def mutate(cells, i):
        old = cells[i(name)]
        cells[i(name)] = new(old.source, id=old.id, metadata=old.metadata)

    return mutate


def reverse(cells, i):
    cells.reverse()


def other_editor(cells, i):
    for number, cell in enumerate(cells):
        cell.id = f'vscode-{number}'


def drop_metadata(name):
    def mutate(cells, i):
        del cells[i(name)].metadata['nbgrader']

    return mutate


CHANGED = {
    'a check is deleted': (delete('double-check'), 'double-check', 'missing'),
    'a hidden check is deleted': (delete('double-hidden'), 'double-hidden', 'missing'),
    'a check is edited': (edit('double-check', 'pass'), 'double-check', 'changed'),
    'a check is emptied': (edit('double-hidden', ''), 'double-hidden', 'changed'),
    'a check is duplicated': (duplicate('double-check'), 'double-check', 'there 2 times'),
    'a check is split': (duplicate('double-check', source='1'), 'double-check', 'there 2 times'),
    'a check became text': (retype('double-check', new_markdown_cell), 'double-check', 'changed'),
    'a check lost its marks': (drop_metadata('double-check'), 'double-check', 'missing'),
    'a reset is deleted': (delete('double-reset'), 'double-reset', 'missing'),
    'a reset is edited': (edit('double-reset', 'pass'), 'double-reset', 'changed'),
}
HOW = {
    'missing': 'was missing: it was put back',
    'changed': "was changed, or is of an earlier release: the lesson's counts",
    'there 2 times': 'was there 2 times: the original counts',
}


@pytest.mark.parametrize(('mutate', 'name', 'how'), CHANGED.values(), ids=CHANGED)
def test_changed_or_missing_locked_and_grade_cells_become_the_originals(
    submitted, template, mutate, name, how
):
    mutate(submitted.cells, lambda name: at(submitted, name))
    restored = restore(submitted, template)
    assert_whole(restored, template)
    assert restored.notes == (f'the cell `{name}` {HOW[how]}',)
    assert restored.notebook.metadata[KEY].notes == list(restored.notes)
    assert by_grade_id(restored.notebook)['double'].source == ANSWER


UNHARMED = {
    'cells in another order': reverse,
    'ids of another editor': other_editor,
    'a demo is deleted': delete('shown'),
    'a setup is deleted': delete('setup'),
    'the title is edited': edit('title', '# Mine'),
    'the "try it" cell is deleted': delete('try-it'),
}


@pytest.mark.parametrize('mutate', UNHARMED.values(), ids=UNHARMED)
def test_changes_that_affect_no_score_are_restored_without_a_note(submitted, template, mutate):
    mutate(submitted.cells, lambda name: at(submitted, name))
    restored = restore(submitted, template)
    assert_whole(restored, template)
    assert restored.notes == ()
    assert by_grade_id(restored.notebook)['double'].source == ANSWER


def split_with_marks(cells, i):
    place = i('double')
    cells.insert(place + 1, nbformat.from_dict(cells[place] | {'id': 'second'}))
    cells[place].source, cells[place + 1].source = 'def half(x):', '    return x / 2'


def copy_left_over(first):
    """A student who wrote into a copy of the answer cell, before or after the released text."""

    def mutate(cells, i):
        place = i('double')
        stub = nbformat.from_dict(cells[place] | {'id': 'stub', 'source': mutate.released})
        cells.insert(place + (0 if first else 1), stub)

    return mutate


ANSWERED = {
    'deleted': (delete('double'), None, 'was missing: it was put back, without an answer'),
    'emptied': (edit('double', ''), '', None),
    'split': (split_with_marks, 'def half(x):\n\n    return x / 2', 'came in 2 parts'),
    'duplicated as it is': (duplicate('double'), ANSWER, 'came in 2 parts'),
    'duplicated and gone on with': (
        duplicate('double', source='x = 1'),
        f'{ANSWER}\n\nx = 1',
        'came in 2 parts',
    ),
    'a copy of the stub before it': (copy_left_over(True), ANSWER, None),
    'a copy of the stub after it': (copy_left_over(False), ANSWER, None),
    'an empty copy': (duplicate('double', source=' \n'), ANSWER, None),
    'another type': (retype('double', new_markdown_cell), ANSWER, 'had another type'),
}


@pytest.mark.parametrize(('mutate', 'source', 'note'), ANSWERED.values(), ids=ANSWERED)
def test_a_restored_answer_keeps_all_that_the_student_wrote(
    submitted, template, mutate, source, note
):
    stub = by_grade_id(template.notebook)['double'].source
    mutate.released = stub
    mutate(submitted.cells, lambda name: at(submitted, name))
    restored = restore(submitted, template)
    assert_whole(restored, template)
    assert by_grade_id(restored.notebook)['double'].source == (stub if source is None else source)
    if note is None:
        assert restored.notes == ()
    else:
        assert [n for n in restored.notes if note in n], restored.notes


def test_the_unmarked_second_part_of_an_answer_follows_it_as_a_free_cell(submitted, template):
    place = at(submitted, 'double')
    submitted.cells.insert(place + 1, new_code_cell('helper = 1', id='double'))
    cells = restore(submitted, template).notebook.cells
    at_answer = next(i for i, c in enumerate(cells) if grade_id(c) == 'double')
    assert (cells[at_answer + 1].source, role(cells[at_answer + 1])) == ('helper = 1', 'free')
    assert cells[at_answer + 1].id != cells[at_answer].id


OWN = {'setup': 'import math\nk = 2', 'shown': 'print(2)', 'try-it': 'double(5)'}


@pytest.mark.parametrize(('name', 'source'), OWN.items(), ids=OWN)
def test_code_that_a_student_wrote_outside_of_answers_stays_as_a_free_cell(
    submitted, template, name, source
):
    original = submitted.cells[at(submitted, name)].source
    submitted.cells[at(submitted, name)].source = source
    cells = restore(submitted, template).notebook.cells
    texts = [c.source for c in cells]
    place = texts.index(source)
    assert cells[place].metadata == {KEY: {'role': 'free'}}
    # the original is still there only where other cells build on it
    assert (texts[place - 1] == original) == (name == 'setup')
    assert texts.count(original) == (name == 'setup')


def test_cells_that_a_student_added_stay_after_the_cell_they_followed(submitted, template):
    submitted.cells.insert(0, new_code_cell('first'))
    submitted.cells.insert(at(submitted, 'double-check') + 1, new_markdown_cell('a thought'))
    submitted.cells.append(new_code_cell('last'))
    submitted.cells.append(new_code_cell('  '))
    cells = restore(submitted, template).notebook.cells
    texts = [c.source for c in cells]
    assert (texts[0], texts[-1]) == ('first', 'last')
    assert grade_id(cells[texts.index('a thought') - 1]) == 'double-check'
    assert role(cells[texts.index('a thought')]) == 'text'


STRANGE = new_code_cell('', metadata={'nbgrader': {'grade_id': 'other'}})


@pytest.mark.parametrize('cells', [[], [new_code_cell('x = 1')], [STRANGE]])
def test_the_first_note_reports_a_notebook_without_answer_cells(template, cells):
    restored = restore(new_notebook(cells=cells), template)
    assert_whole(restored, template)
    what, _, advice = restored.notes[0].partition(': ')
    assert what == 'the notebook holds none of the answer cells of this assignment'
    assert 'it is another notebook, they were deleted, or a program' in advice
    assert 'save it in JupyterLab, and submit that file' in advice


def test_attachments_of_a_manual_answer_are_kept(submitted, template):
    pictures = {'arm.png': {'image/png': 'AAAA'}}
    submitted.cells[at(submitted, 'explain')].attachments = pictures
    assert by_grade_id(restore(submitted, template).notebook)['explain'].attachments == pictures


FORGED = {
    'tags': ['skip-execution', 'raises-exception', 'demo'],
    'nbgrader': {'points': 99, 'schema_version': 1, 'solution': True, 'grade': False},
    KEY: {'role': 'setup', 'outcome': 'passed', 'reason': 'forged', 'notes': ['forged']},
    'deletable': False,
    'jupyter': {'source_hidden': True},
}


def test_metadata_and_outputs_that_a_student_forged_are_dropped(submitted, template):
    untouched = restore(submitted, template)
    submitted.cells.insert(3, new_code_cell('mine = 1'))
    expected = restore(submitted, template).notebook
    for cell in submitted.cells:
        marks = {'grade_id': grade_id(cell)} if grade_id(cell) else {}
        cell.metadata = nbformat.from_dict(FORGED | {'nbgrader': FORGED['nbgrader'] | marks})
        if cell.cell_type == 'code':
            cell.outputs = [nbformat.v4.new_output('stream', text='forged')]
            cell.execution_count = 3
    submitted.metadata = nbformat.from_dict({KEY: {'problem': 'forged'}, 'kernelspec': 'forged'})
    restored = restore(submitted, template)
    mine = [c for c in expected.cells if c.source == 'mine = 1']
    assert [c.metadata for c in mine] == [{KEY: {'role': 'free'}}]
    assert [c.metadata for c in restored.notebook.cells] == [c.metadata for c in expected.cells]
    assert [c.get('outputs') for c in restored.notebook.cells] == [
        c.get('outputs') for c in expected.cells
    ]
    assert restored.notebook.metadata == untouched.notebook.metadata


def test_restoring_changes_neither_the_submission_nor_the_template(submitted, template):
    before = (nbformat.writes(submitted), nbformat.writes(template.notebook))
    restore(submitted, template).notebook.cells[3].metadata.nbgrader.points = 7
    assert (nbformat.writes(submitted), nbformat.writes(template.notebook)) == before


def test_restoring_a_restored_notebook_changes_nothing(submitted, template):
    reverse(submitted.cells, None)
    del submitted.cells[2]
    once = restore(submitted, template).notebook
    twice = restore(once, template)
    assert twice.notes == ()
    assert twice.notebook.cells == once.cells


TEXTS = st.sampled_from(['', ' ', 'pass', ANSWER, '%%bash\nrm', 'raise SystemExit', 'a\n\nb'])
IDS = st.sampled_from(['double', 'double-check', 'double-reset', 'explain', 'other', ''])
MUTATIONS = st.lists(
    st.tuples(
        st.sampled_from(['delete', 'copy', 'move', 'edit', 'retype', 'unmark', 'mark', 'forge']),
        st.integers(0, 30),
        st.integers(0, 30),
        TEXTS,
        IDS,
    ),
    max_size=15,
)


@settings(max_examples=150, deadline=None)
@given(mutations=MUTATIONS)
def test_restoring_always_yields_every_cell_of_the_source_once_and_in_order(course, mutations):
    template = make_template(course.source(TOY), course.release(TOY))
    notebook = answered(course, ANSWER)
    for what, which, other, text, name in mutations:
        if not notebook.cells:
            break
        mutated(notebook.cells, what, which % len(notebook.cells), other, text, name)
    assert_whole(restore(notebook, template), template)


def mutated(cells, what, place, other, text, name):
    cell = cells[place]
    if what == 'delete':
        del cells[place]
    elif what == 'copy':
        cells.insert(other % len(cells), nbformat.from_dict(cell))
    elif what == 'move':
        cells.insert(other % len(cells), cells.pop(place))
    elif what == 'edit':
        cell.source = text
    elif what == 'retype':
        new = new_markdown_cell if cell.cell_type == 'code' else new_code_cell
        cells[place] = new(cell.source, metadata=cell.metadata)
    elif what == 'unmark':
        cell.metadata.pop('nbgrader', None)
    elif what == 'mark':
        cell.metadata['nbgrader'] = nbformat.from_dict({'grade_id': name, 'points': 50})
    elif what == 'forge':
        cell.metadata = nbformat.from_dict(FORGED | {'nbgrader': {'grade_id': name}})
