"""Which ROS packages a lesson asks for: exactly those that its locked cells build.

The folder of such a package, beside the notebook, is the answer of its exercise.
"""

import ast
import re

from nbformat import NotebookNode

from my_robot_basics.validate.lessons.cells import role

BUILD = 'build_package'
"""The function of `live` that a locked cell calls with a package's name."""
_NAME = re.compile(r'[a-z][a-z0-9_]*')


def packages_of(notebook: NotebookNode) -> tuple[str, ...]:
    """Return the packages that belong to a lesson's submission, in the order of its cells."""
    names = (name for cell in notebook.cells for name in packages_built_by(cell))
    return tuple(dict.fromkeys(names))


def packages_built_by(cell: NotebookNode) -> tuple[str, ...]:
    """Return the packages that a locked cell builds; () for other cells, such as a student's."""
    if cell.cell_type != 'code' or BUILD not in cell.source or role(cell) != 'locked':
        return ()
    try:
        tree = ast.parse(cell.source)
    except (SyntaxError, ValueError):
        return ()
    return tuple(
        argument.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and _name_of(node.func) == BUILD
        for argument in node.args[:1]
        if isinstance(argument, ast.Constant)
        and isinstance(argument.value, str)
        and _NAME.fullmatch(argument.value)
    )


def _name_of(function: ast.expr) -> str:
    """Return a called function's name, without its module: `live.build_package` also counts."""
    return str(getattr(function, 'id', getattr(function, 'attr', '')))
