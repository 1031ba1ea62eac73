"""A lesson whose exercises ask for functions that double, as a student handed it in."""

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from grader.notebook.restore import grade_id, make_template, restore

CANARY = 'hidden canary'
CHECK = f"""
from my_robot_basics.checks import expect, student
expect(student.call('double', 2) == 4, expected=4, seen='less', hint='twice')
print('note: all is well')
secret = '{CANARY}'
"""


def marked(name, source, *, new=new_code_cell, **marks):
    defaults = {'grade': False, 'solution': False, 'locked': True, 'schema_version': 3}
    return new(source, id=name, metadata={'nbgrader': defaults | marks | {'grade_id': name}})


def lesson(*exercises, check=CHECK, setup='from my_robot_basics.live import reset'):
    """Return the instructor's notebook; exercise `a` asks for `double_a`, and so on."""
    cells = [new_code_cell(setup, id='setup')]
    for name in exercises:
        cells += [
            marked(f'{name}-reset', f"reset('double_{name}')"),
            marked(name, '# here', solution=True, locked=False),
            new_code_cell('# try it', id=f'{name}-try'),
            marked(
                f'{name}-check', check.replace('double', f'double_{name}'), grade=True, points=2
            ),
        ]
    cells.append(marked('why', '', new=new_markdown_cell, solution=True, grade=True, points=3))
    return new_notebook(cells=cells)


def handed_in(source, *, after=(), before=(), **answers):
    """Return a student's restored notebook with these answers, and own cells before and after."""
    template = make_template(source, source)
    submitted = nbformat.from_dict(source)
    for cell in submitted.cells:
        if name := grade_id(cell):
            cell.source = answers.get(name, cell.source).replace('double', f'double_{name}')
    cells = [*map(new_code_cell, before), *submitted.cells, *map(new_code_cell, after)]
    return restore(new_notebook(cells=cells), template).notebook


def outcomes(execution):
    return {v.grade_id: v.outcome for v in execution.verdicts}


def cells_of(execution):
    return {grade_id(c): c for c in execution.notebook.cells if grade_id(c)}


GOOD = 'def double(x): return 2 * x'
