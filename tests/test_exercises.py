"""Finding exercises in a lesson."""

from my_robot_basics.validate.lessons.exercises import find_exercises
from nbformat.v4 import new_code_cell, new_notebook
from small_lesson import lesson


def test_exercises_are_found_with_their_cells():
    notebook = lesson(at_start='x = 1')
    area, node = find_exercises(notebook)
    assert (area.name, area.defines) == ('area', ('area',))
    assert (node.name, node.defines) == ('node', ('Talker', 'rate_hz'))
    assert (area.run, len(node.run)) == ((), 1)
    places = [(e.reset, e.answer, *e.run, *e.grades) for e in (area, node)]
    names = [[notebook.cells[i].metadata.nbgrader.grade_id for i in each] for each in places]
    assert names == [
        ['area-reset', 'area', 'area-visible', 'area-hidden'],
        ['node-reset', 'node', 'node-run', 'node-check'],
    ]


def test_a_lesson_without_exercises_has_none():
    assert find_exercises(new_notebook(cells=[new_code_cell('x = 1')])) == ()
