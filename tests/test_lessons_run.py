"""Each lesson runs twice in a kernel; unanswered, only its checks fail and say what is missing."""

import ast
import dis
import re
import shutil
from contextlib import contextmanager
from pathlib import Path

import nbformat
import pytest
from IPython.core.inputtransformer2 import TransformerManager
from nbclient import NotebookClient

ROOT = Path(__file__).parents[1]
SOURCES = sorted(ROOT.glob('solutions/*/*.ipynb'))
NAMES = [path.stem for path in SOURCES]
PROGRAMS = re.compile(r'^(!|%%bash)|\bPopen\(', re.MULTILINE)
"""Found in cells that start programs: they take long, and leave nothing in the kernel."""


@pytest.mark.slow
@pytest.mark.parametrize('all_cells', [False, pytest.param(True, marks=pytest.mark.slow)])
@pytest.mark.parametrize('name', NAMES)
def test_a_lesson_runs_again_in_the_same_kernel_whatever_was_run_between(
    name, all_cells, tmp_path
):
    lesson = read('solutions', name)
    everything = code_cells(lesson)
    within = [cell for cell in everything if not is_left_out(cell)]
    unchecked = [cell for cell in within if not is_grade(cell)]
    # nbval runs each in a fresh kernel; here cells may fail because others are missing, but none
    # may hang or kill the kernel
    first = [*unchecked, *reversed(within)]
    last = everything
    if not all_cells:
        first = [*needed(unchecked), *reversed(unchecked)]
        last = within
    files = shutil.copytree(ROOT / 'solutions' / name, tmp_path / name)  # a package, say
    with kernel_for(lesson, files) as run:
        for cell in first:
            run(cell)
        for cell in last:
            run(cell)
            assert errors(cell) == [], cell.id
            assert 'stderr' not in [output.get('name') for output in cell.outputs], cell.id


@pytest.mark.parametrize('name', NAMES)
def test_an_unanswered_lesson_fails_in_its_checks_alone_and_says_what_is_missing(
    name, tmp_path, monkeypatch
):
    # the package of the lesson's solution is in that of the tests
    monkeypatch.setenv('MY_ROBOT_BASICS_WORKSPACE', str(tmp_path))
    lesson = read('notebooks', name)
    with kernel_for(lesson) as run:
        for cell in code_cells(lesson):
            is_shown = 'demo' in cell.metadata.get('tags', []) or cell.id.endswith('-try')
            if is_shown and 'make_workspace(' not in cell.source:  # a later cell writes into it
                continue
            run(cell)
            if is_grade(cell) and not left_to_grading(cell):
                assert len(errors(cell)) == 1, cell.id
            for error in errors(cell):
                expected = 'CheckFailed' if is_grade(cell) else 'NotRunnable'
                assert error.ename == expected, cell.id
                assert re.fullmatch(r'expected .+, saw .+: .+', error.evalue), cell.id


@contextmanager
def kernel_for(lesson, folder=None):
    """Yield a function that runs one cell of the lesson in a fresh kernel, in that folder."""
    resources = {'metadata': {'path': str(folder)}} if folder else {}
    client = NotebookClient(
        lesson, resources=resources, timeout=180, allow_errors=True, kernel_name='python3'
    )
    with client.setup_kernel():
        yield lambda cell: client.execute_cell(cell, lesson.cells.index(cell))


def read(folder, name):
    return nbformat.read(ROOT / folder / name / f'{name}.ipynb', as_version=4)


def code_cells(lesson):
    return [cell for cell in lesson.cells if cell.cell_type == 'code']


def is_left_out(cell):
    return PROGRAMS.search(cell.source) and 'stop()' not in cell.source


def needed(cells):
    """Return the cells that bind a name which other cells use."""
    binds, uses = zip(*map(names_in, cells), strict=True)
    asked = [set().union(*uses[:at], *uses[at + 1 :]) for at in range(len(cells))]
    return [
        cell for cell, *both in zip(cells, binds, asked, strict=True) if set.intersection(*both)
    ]


def names_in(cell):
    """Return the names that a cell binds, and those that it takes from others."""
    source = TransformerManager().transform_cell(cell.source)
    steps = dis.get_instructions(compile(source, cell.id, 'exec'))
    binds = {step.argval for step in steps if step.opname == 'STORE_NAME'}
    nodes = ast.walk(ast.parse(source))
    return binds, {node.id for node in nodes if isinstance(node, ast.Name)} - binds


def is_grade(cell):
    return cell.metadata.get('nbgrader', {}).get('grade', False)


def errors(cell):
    return [output for output in cell.outputs if output.output_type == 'error']


def left_to_grading(cell):
    """Whether a grade cell says that none of its checks is for students to see."""
    return [output.get('text') for output in cell.outputs] == ['checked at grading\n']
