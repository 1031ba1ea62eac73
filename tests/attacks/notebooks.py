"""Attacks outside of the answers: notebooks with edited cells, and files beside a notebook.

Each function takes the released toy lesson, without an answer, and the folder in which it is
handed in; its first line says what it tries. None of them earns a point.
"""

import json
import zipfile
from pathlib import Path

from nbformat import NotebookNode
from nbformat.v4 import new_code_cell

from grader.notebook.restore import KEY


def skips_its_checks(notebook: NotebookNode, folder: Path) -> None:
    """Tags the checks so that they are not run: stock nbgrader gives full marks for that."""
    for cell in notebook.cells:
        cell.metadata['tags'] = ['skip-execution', 'raises-exception', 'demo']


def raises_its_points(notebook: NotebookNode, folder: Path) -> None:
    """Says that each check is worth 330 points, and that an empty cell is a check."""
    for cell in notebook.cells:
        marks = cell.metadata.get('nbgrader')
        if marks and marks.get('grade'):
            marks['points'] = 330
    marks = dict(marks or {}) | {'grade': True, 'points': 330, 'grade_id': 'extra', 'locked': True}
    notebook.cells.append(new_code_cell('', metadata={'nbgrader': marks}))


def edits_its_checks(notebook: NotebookNode, folder: Path) -> None:
    """Replaces the checks by checks that always pass."""
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('grade'):
            cell.source = 'print("passed")'


def is_made_of_magics(notebook: NotebookNode, folder: Path) -> None:
    """Answers with magics only: IPython parses the cell again for each, and finally gives up."""
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('solution') and cell.cell_type == 'code':
            cell.source = 'x = %who\n' * 600


def makes_text_of_its_checks(notebook: NotebookNode, folder: Path) -> None:
    """Turns the checks into cells that nobody runs."""
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('grade'):
            cell.cell_type = 'raw'
            cell.pop('outputs', None)
            cell.pop('execution_count', None)


def repeats_its_ids(notebook: NotebookNode, folder: Path) -> None:
    """Hands in each check twice, the second one empty."""
    for cell in list(notebook.cells):
        if cell.metadata.get('nbgrader', {}).get('grade'):
            again = json.loads(json.dumps(cell)) | {'source': 'pass'}
            notebook.cells.append(type(notebook)(again))


def claims_to_be_graded(notebook: NotebookNode, folder: Path) -> None:
    """Has the metadata in which the grader stores a verdict."""
    passed = {'outcome': 'passed', 'reason': '', 'role': 'grade', 'notes': []}
    notebook.metadata[KEY] = passed
    for cell in notebook.cells:
        cell.metadata[KEY] = passed


def asks_for_a_kernel_of_its_own(notebook: NotebookNode, folder: Path) -> None:
    """Names a kernel of its own, and brings its kernelspec."""
    notebook.metadata['kernelspec'] = {'name': 'evil', 'display_name': 'evil', 'language': 'sh'}
    (folder / 'kernel.json').write_text(json.dumps({'argv': ['touch', '/tmp/evil_kernel']}))


def brings_modules_of_ours(notebook: NotebookNode, folder: Path) -> None:
    """Hands in modules that have the names of modules that grading imports."""
    evil = 'import builtins; builtins.AssertionError = Warning'
    names = ('rclpy', 'ipykernel_launcher', 'my_robot_basics', 'sitecustomize', 'usercustomize')
    for name in (*names, 'json', 'numpy', 'grader', 'IPython'):
        (folder / f'{name}.py').write_text(evil)
    (folder / 'evil.pth').write_text(f'import os; {evil}')


def brings_modules_that_nobody_has(notebook: NotebookNode, folder: Path) -> None:
    """Hands in optional modules that libraries try to import, to end the kernel as it starts."""
    for name in ('regex', 'atomicwrites', 'future_builtins', 'debugpy', 'ujson', 'uvloop'):
        (folder / f'{name}.py').write_text('import os; os._exit(0)')


def brings_links(notebook: NotebookNode, folder: Path) -> None:
    """Hands in links to files of the machine."""
    (folder / 'secrets.py').symlink_to('/etc/passwd')
    (folder / 'shadow.py').symlink_to('/etc/shadow')


def brings_an_archive(notebook: NotebookNode, folder: Path) -> None:
    """Hands in an archive that would be unpacked outside of its folder."""
    with zipfile.ZipFile(folder / 'more.zip', 'w') as archive:
        archive.writestr('../../../../tmp/slipped', 'x')
