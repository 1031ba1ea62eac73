"""A small lesson with two exercises, with a student's changes."""

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

from grader.notebook.restore import make_template, restore


def marked(name, source='', *, new=new_code_cell, **marks):
    defaults = {'grade': False, 'solution': False, 'locked': True, 'schema_version': 3}
    return new(source, metadata={'nbgrader': defaults | marks | {'grade_id': name}})


def grade(name):
    return marked(name, 'check()', grade=True, points=1)


def answer(name, source=''):
    return marked(name, source, solution=True, locked=False)


SOURCE = new_notebook(
    cells=[
        new_markdown_cell('# A lesson'),
        new_code_cell('import math'),
        new_code_cell('shown = 1', metadata={'tags': ['demo']}),
        marked('area-reset', "reset('area')"),
        answer('area'),
        new_code_cell('# try it'),
        grade('area-visible'),
        grade('area-hidden'),
        new_code_cell('import cmath'),
        marked('node-reset', "reset('Talker', 'rate_hz')"),
        answer('node'),
        marked('node-run', "run_answer('Talker')"),
        new_code_cell('# try that'),
        grade('node-check'),
        marked('why', new=new_markdown_cell, solution=True, grade=True, points=2, locked=False),
    ]
)


def lesson(area='def area(r): return r', node='class Talker: pass\nrate_hz = 5', **own):
    """Return the restored lesson; `own` has the student's own cells, by their position."""
    template = make_template(nbformat.from_dict(SOURCE), nbformat.from_dict(SOURCE))
    submitted = nbformat.from_dict(SOURCE)
    places = {'at_start': 0, 'before_area': 3, 'after_area': 8, 'at_end': 15}
    for cell in submitted.cells:
        if (cell.metadata.get('nbgrader') or {}).get('grade_id') in ('area', 'node'):
            cell.source = area if cell.metadata.nbgrader.grade_id == 'area' else node
        if cell.source == '# try it':
            cell.source = own.pop('try_it', cell.source)
    for place, source in sorted(own.items(), key=lambda item: -places[item[0]]):
        submitted.cells.insert(places[place], new_code_cell(source))
    return restore(submitted, template).notebook
