import json
import re
import shutil
from pathlib import Path

import nbformat
import pytest
from course_maker import PIXEL, TOY, make_course, toy_lesson, write_source
from my_robot_basics.validate.lessons.cells import KEY, fingerprint
from my_robot_basics.validate.lessons.lesson import read_lesson
from nbgrader.utils import compute_checksum

from grader.authoring.exercise_cells import outside_of_exercises
from grader.authoring.hidden_points import MarkHidden
from grader.authoring.leaks import leaks_of
from grader.authoring.markers import marker_faults
from grader.authoring.release import release, stale_or_leaking
from grader.authoring.release_passes import uncomment_broken_lines
from grader.common.errors import CourseError
from grader.course import Course


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    course = make_course(tmp_path_factory.mktemp('course'))
    assert release(course) == [f'{TOY}/{TOY}.ipynb', 'index.ipynb']
    return course


def cells(course):
    return {cell.id: cell for cell in course.release(TOY).cells}


def test_a_release_holds_no_answer_and_no_hidden_test(course):
    text = course.release_path(TOY).read_text()
    assert 'secret answer' not in text
    assert 'canary' not in text
    assert 'HIDDEN' not in text
    assert 'Other numbers are doubled too' in text


def test_a_release_keeps_outputs_of_demonstrations_and_clears_all_others(course):
    shown = cells(course)['shown']
    assert shown.outputs[0].text == 'shown\n'
    assert shown.outputs[1].data['image/png'].strip() == PIXEL
    assert shown.execution_count is shown.outputs[1].execution_count is None
    assert not cells(course)['setup'].outputs


def test_a_release_carries_only_the_metadata_it_needs(course):
    notebook = json.loads(course.release_path(TOY).read_text())
    assert notebook['metadata'].keys() == {'kernelspec', 'language_info', 'my_robot_basics'}
    assert notebook['metadata']['kernelspec']['name'] == 'python3'
    keys = {key for cell in notebook['cells'] for key in cell['metadata']}
    assert keys == {'nbgrader', 'tags', 'deletable', 'editable'}


def test_a_release_records_roles_and_fingerprints_and_which_cells_hide_tests(course):
    record = course.release(TOY).metadata.my_robot_basics.cells
    assert {name: mark.role for name, mark in record.items()}.items() >= {
        ('setup', 'setup'), ('shown', 'demo'), ('double', 'answer'), ('double-reset', 'locked'),
    }  # fmt: skip
    source = {cell.id: cell.source for cell in course.source(TOY).cells}
    hidden = {name for name, text in source.items() if 'HIDDEN' in text}
    assert hidden
    assert {name for name, mark in record.items() if 'hidden' in mark} == hidden
    given = {cell.id: cell.source for cell in course.release(TOY).cells}
    assert all(mark.source == fingerprint(given[name]) for name, mark in record.items())


VISIBLE_PARTS = {
    'a check': ('expect(x, seen=y)', 'part'),
    'a loop': ('for x in y:\n    expect(x)', 'part'),
    'imports, and a word on it': ('from math import pi\nprint("checked at grading")', 'all'),
    'nothing': ('', 'all'),
}


def test_cells_may_have_the_ids_that_jupyterlab_gives_them(tmp_path):
    course = make_course(tmp_path / 'course')
    lesson = toy_lesson()
    for number, cell in enumerate(lesson.cells):
        cell.id = f'{number:08x}-1a2b'
    write_source(course, lesson)
    release(course)
    given = read_lesson(course.release_path(TOY))
    assert (given.notes, given.missing) == ((), {})
    assert given.hidden == {'double-hidden': 'part'}
    roles = [cell.metadata[KEY].role for cell in given.notebook.cells]
    assert roles == [
        *('text', 'setup', 'demo', 'locked', 'answer', 'free', 'grade', 'grade'),
        'answer',
    ]
    changed = course.release(TOY)
    del changed.cells[6]  # double-check
    nbformat.write(changed, course.release_path(TOY))
    assert read_lesson(course.release_path(TOY)).missing == {'double-check': 1}


@pytest.mark.parametrize(('shown', 'hidden'), VISIBLE_PARTS.values(), ids=VISIBLE_PARTS)
def test_a_check_is_marked_as_hidden_in_part_or_as_a_whole(shown, hidden):
    source = f'"""A title"""\n{shown}\n### BEGIN HIDDEN TESTS\n1 / 0\n### END HIDDEN TESTS'
    marks = {'grade': True, 'grade_id': 'a', 'points': 1}
    cell = nbformat.v4.new_code_cell(source, id='a', metadata={'nbgrader': marks})
    notebook, _ = MarkHidden().preprocess(nbformat.v4.new_notebook(cells=[cell]), {})
    assert notebook.metadata.my_robot_basics.cells.a == {'role': 'grade', 'hidden': hidden}


def test_releasing_again_changes_nothing(course):
    before = course.release_path(TOY).read_bytes()
    assert release(course, TOY) == []
    assert stale_or_leaking(course) == []
    assert course.release_path(TOY).read_bytes() == before


FIXED = """def double(x):
    # 1. why is it wrong?
    ### BEGIN SOLUTION
    y = x  # the same in both
    return x + y  # the secret answer
    ### END SOLUTION
    ### BROKEN: y = x  # the same in both
    ### BROKEN: if y:
    ### BROKEN:     return x - y"""


def test_an_answer_with_broken_lines_is_released_with_them_in_place_of_the_solution(course):
    before = course.release_path(TOY).read_bytes()
    lesson = toy_lesson()
    lesson.cells[4].source = FIXED
    write_source(course, lesson)
    release(course)
    released = cells(course)['double']
    assert released.source == (
        'def double(x):\n'
        '    # 1. why is it wrong?\n'
        '    y = x  # the same in both\n'
        '    if y:\n'
        '        return x - y'
    )
    assert released.metadata.nbgrader.checksum == compute_checksum(released)
    assert stale_or_leaking(course) == []

    path = course.release_path(TOY)
    path.write_text(path.read_text().replace('return x - y', 'return x + y  # the secret answer'))
    assert any('secret answer' in found for found in leaks_of(course, TOY, path.parents[1]))

    write_source(course, toy_lesson())
    release(course)
    assert course.release_path(TOY).read_bytes() == before


@pytest.mark.parametrize(
    'source',
    [
        '### BROKEN: x = 1',
        '# YOUR CODE HERE\n\n### BROKEN: x = 1',
        '# YOUR CODE HERE\n### BROKEN:\n',
    ],
)
def test_broken_lines_that_do_not_follow_a_solution_are_refused(source):
    with pytest.raises(CourseError, match='right after ### END SOLUTION'):
        uncomment_broken_lines(source)


def test_a_failed_release_leaves_the_former_release_unchanged(course):
    before = course.release_path(TOY).read_bytes()
    broken = toy_lesson()
    broken.cells[4].source += '\n\n### BROKEN: x = 1'
    write_source(course, broken)
    with pytest.raises(CourseError, match='right after ### END SOLUTION'):
        release(course)
    assert course.release_path(TOY).read_bytes() == before
    write_source(course, toy_lesson())


UNPAIRED = {
    'no end': (
        '1\n### BEGIN HIDDEN TESTS\n2',
        "line 2: 'BEGIN HIDDEN TESTS' has no end: add a line '### END HIDDEN TESTS' after the"
        ' last hidden line',
    ),
    'two beginnings': (
        '### BEGIN HIDDEN TESTS\n1\n### BEGIN HIDDEN TESTS\n2\n### END HIDDEN TESTS',
        "line 1: 'BEGIN HIDDEN TESTS' has no end: add a line '### END HIDDEN TESTS' before line 3,"
        ' where another begins',
    ),
    'no beginning': (
        '1\n### END HIDDEN TESTS',
        "line 2: 'END HIDDEN TESTS' ends nothing: add a line '### BEGIN HIDDEN TESTS' before what"
        ' students must not see, or remove this one',
    ),
    'another kind of cell': (
        '### BEGIN SOLUTION\n1\n### END SOLUTION',
        "line 1: 'BEGIN SOLUTION' is in a cell of another type: give the cell the type"
        " 'Autograded answer' in Create Assignment, or remove the line",
    ),
    'misspelt': (
        '1\n### BEGIN HIDDEN TEST\n2',
        "line 2: 'BEGIN HIDDEN TEST' marks nothing: write '### BEGIN HIDDEN TESTS'",
    ),
    'in small letters': (
        '1\n# Begin solution:\n2',
        "line 2: 'Begin solution:' marks nothing: write '### BEGIN SOLUTION'",
    ),
    'no end of a mark scheme': (
        '### BEGIN MARK SCHEME\n1',
        "line 1: 'BEGIN MARK SCHEME' has no end: add a line '### END MARK SCHEME' after its last"
        ' line',
    ),
}


@pytest.mark.parametrize(('source', 'fault'), UNPAIRED.values(), ids=UNPAIRED)
def test_a_misplaced_or_unpaired_marker_is_reported_with_its_fix(source, fault):
    lesson = toy_lesson()
    assert list(marker_faults(lesson)) == []
    lesson.cells[7].source = source
    assert list(marker_faults(lesson)) == [f'the cell `double-hidden`, {fault}']


def test_a_lesson_with_an_unpaired_marker_is_not_released(course):
    lesson = toy_lesson()
    lesson.cells[7].source = lesson.cells[7].source.replace('### END HIDDEN TESTS', '')
    write_source(course, lesson)
    said = f'solutions/{TOY}/{TOY}.ipynb cannot be released: the cell `double-hidden`, line '
    with pytest.raises(CourseError, match=f'^{re.escape(said)}'):
        release(course)
    write_source(course, toy_lesson())


def test_an_answer_left_in_the_cell_to_experiment_in_is_not_released(course):
    lesson = toy_lesson()
    lesson.cells[5].source = lesson.cells[4].source.replace('### BEGIN SOLUTION', '')
    lesson.cells[5].source = lesson.cells[5].source.replace('### END SOLUTION', '')
    write_source(course, lesson)
    with pytest.raises(CourseError, match='shows a line of an answer'):
        release(course)
    write_source(course, toy_lesson())


def test_metadata_and_markers_are_reported_at_once(course):
    lesson = toy_lesson()
    del lesson.cells[6].metadata.nbgrader['points']
    lesson.cells[7].source = lesson.cells[7].source.replace('### END HIDDEN TESTS', '')
    write_source(course, lesson)
    with pytest.raises(
        CourseError, match=r'`double-check` has no points.*HIDDEN TESTS. has no end'
    ):
        release(course)
    write_source(course, toy_lesson())


def test_a_notebook_beside_the_lessons_that_is_no_quiz_is_named(course):
    path = course.root / 'solutions' / 'quiz_mine.ipynb'
    path.write_text('{}')
    said = []
    release(course, say=said.append)
    path.unlink()
    assert [line.split(': ')[0] for line in said if 'not released' in line] == [
        'solutions/quiz_mine.ipynb is not released'
    ]


def test_a_notebook_of_another_name_than_its_folder_is_not_released(course):
    copy = course.root / 'solutions' / '99_copy'
    shutil.copytree(course.source_path(TOY).parent, copy)
    said = f'solutions/99_copy/{TOY}.ipynb cannot be released: give the notebook the name of'
    with pytest.raises(CourseError, match=re.escape(said)):
        release(course)
    shutil.rmtree(copy)
    assert not (course.root / 'notebooks' / '99_copy').exists()


def drop(*names):
    lesson = toy_lesson()
    lesson.cells = [cell for cell in lesson.cells if cell.id not in names]
    return lesson


def with_second_answer():
    """The second exercise has no reset cell: its check would be judged with the first answer."""
    lesson = toy_lesson()
    for cell in drop('double-reset').cells[3:6]:
        cell.id = cell.id.replace('double', 'triple')
        if cell.metadata.get('nbgrader'):
            cell.metadata.nbgrader.grade_id = cell.id
        lesson.cells.append(cell)
    return lesson


OUTSIDE = {
    'no reset cell': (drop('double-reset'), ['answer cell `double`', 'id `double-reset` before']),
    'no reset cell behind an exercise': (
        with_second_answer(),
        ['answer cell `triple`', 'id `triple-reset` before'],
    ),
    'no answer cell': (drop('double'), ['check `double-check`', 'put an answer cell before it']),
    'neither': (drop('double', 'double-reset'), ['check `double-hidden`', 'with `-reset`']),
}


@pytest.mark.parametrize(('lesson', 'said'), OUTSIDE.values(), ids=OUTSIDE)
def test_a_check_outside_of_an_exercise_is_reported_with_the_missing_cell(lesson, said):
    faults = '; '.join(outside_of_exercises(lesson))
    assert all(words in faults for words in said)


def test_an_exercise_without_its_reset_cell_is_not_released(course):
    write_source(course, drop('double-reset'))
    said = f'^solutions/{TOY}/{TOY}.ipynb cannot be released: the answer cell `double` '
    with pytest.raises(CourseError, match=said):
        release(course)
    write_source(course, toy_lesson())


def answer(notebook):
    notebook.cells[4].source = 'def double(x):\n    return 2 * x'


def run_a_cell(notebook):
    notebook.cells[5].execution_count = 1


def save_in_jupyterlab(notebook):
    notebook.metadata.language_info.version = '3.11.7'


@pytest.mark.parametrize('work', [answer, run_a_cell, save_in_jupyterlab])
def test_work_in_a_release_is_copied_before_the_release_is_replaced(course, work):
    path = course.release_path(TOY)
    before = path.read_bytes()
    notebook = course.release(TOY)
    work(notebook)
    nbformat.write(notebook, path)
    worked_in = path.read_bytes()
    said = []
    assert release(course, TOY, say=said.append) == [f'{TOY}/{TOY}.ipynb']
    (line,) = (
        each
        for each in said
        if f'notebooks/{TOY}/{TOY}.ipynb was replaced, but contained work' in each
    )
    copy = Path(line.partition('kept as ')[2])
    assert course.gradebook / 'replaced' in copy.parents
    assert copy.read_bytes() == worked_in
    assert path.read_bytes() == before


@pytest.mark.slow
def test_a_release_that_is_no_notebook_any_more_is_copied_before_it_is_replaced(course):
    path = course.release_path(TOY)
    path.write_text('{')
    said = []
    release(course, TOY, say=said.append)
    (copy,) = (each.partition('kept as ')[2] for each in said if 'kept as' in each)
    assert Path(copy).read_text() == '{'


def test_a_release_that_nobody_touched_is_replaced_without_a_copy(course):
    lesson = toy_lesson()
    lesson.cells[0].source = '# Another toy'
    write_source(course, lesson)
    said = []
    assert f'{TOY}/{TOY}.ipynb' in release(course, say=said.append)
    write_source(course, toy_lesson())
    release(course, say=said.append)
    assert not [each for each in said if 'kept as' in each]


def test_an_unknown_assignment_is_reported_with_the_existing_ones(course):
    with pytest.raises(CourseError, match=f"no assignment '99'.*{TOY}"):
        release(course, '99')


def test_a_stale_release_and_strange_files_are_found(course):
    path = course.release_path(TOY)
    before = path.read_text()
    path.write_text(before.replace('# A toy', '# A tool'))
    (path.parent / 'notes.txt').write_text('old')
    found = stale_or_leaking(course)
    assert [line.split(':')[0] for line in found] == [
        f'notebooks/{TOY}/{TOY}.ipynb differs from what solutions/ gives',
        f'notebooks/{TOY}/notes.txt belongs to no assignment',
    ]
    path.write_text(before)
    (path.parent / 'notes.txt').unlink()


@pytest.mark.parametrize(
    ('cell', 'leak'),
    [
        ('try-it', '### BEGIN SOLUTION'),
        ('try-it', 'assert student.call("double", 21) == 42, "count again"  # hidden canary'),
        ('title', '    return x + x  # the secret answer'),
        ('explain', 'Because it is added to itself.'),
        ('shown-output', 'return x + x  # the secret answer\n'),
    ],
)
def test_each_kind_of_leak_into_a_release_is_found(course, cell, leak):
    path = course.release_path(TOY)
    before = path.read_text()
    notebook = json.loads(before)
    by_id = {c['id']: c for c in notebook['cells']}
    if cell == 'shown-output':
        by_id['shown']['outputs'][0]['text'] = leak
    else:
        by_id[cell]['source'] = leak
    path.write_text(json.dumps(notebook))
    assert list(leaks_of(course, TOY, course.root / 'notebooks'))
    path.write_text(before)
    assert not list(leaks_of(course, TOY, course.root / 'notebooks'))


def test_a_lesson_is_not_released_if_a_demonstration_prints_an_answer(course):
    lesson = toy_lesson()
    lesson.cells[2].outputs[0].text = 'return x + x  # the secret answer'
    write_source(course, lesson)
    with pytest.raises(CourseError, match=r'nothing was released.*secret answer'):
        release(course)
    write_source(course, toy_lesson())


def test_the_releases_of_this_course_are_up_to_date_and_leak_nothing():
    found = stale_or_leaking(Course())
    # lesson 11 may run beside this, and then has this file in its folder for some seconds
    assert [each for each in found if '/11_parameters/arm.yaml ' not in each] == []


def test_only_locked_cells_of_releases_may_raise_without_stopping_run_all():
    course = Course()
    for name in course.assignments():
        for cell in course.release(name).cells:
            locked = cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('locked')
            assert ('raises-exception' in cell.metadata.get('tags', [])) == bool(locked), cell.id
        assert 'raises-exception' not in course.source_path(name).read_text(encoding='utf-8')
