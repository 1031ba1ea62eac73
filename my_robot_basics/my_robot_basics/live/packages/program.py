"""Make a program from a node class of the notebook: its text, and the names that it needs."""

import ast
import builtins
import linecache
import symtable
import sys
import textwrap
from collections.abc import Iterable
from types import FunctionType, ModuleType
from typing import Any

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.session.errors import LiveError, in_lines

ONLY_IN_NOTEBOOKS = {'display', 'get_ipython'}
"""IPython adds these to the builtins; a `!` or `%` line needs the second one."""
INDENT = '  '
"""Indentation of the lines with hints about names."""
_EVERYWHERE = (vars(builtins).keys() - ONLY_IN_NOTEBOOKS) | {'__file__', '__name__', '__doc__'}


class NotAProgram(LiveError):
    """A cell cannot become a program as it is; the message may have several lines."""

    def _render_traceback_(self) -> list[str]:
        first, *others = str(self).splitlines()
        lines = in_lines(f'{type(self).__name__}: {in_language_here(first)}')
        for other in others:
            said = other.removeprefix(INDENT)
            lines += in_lines(in_language_here(said), first=INDENT if said != other else '')
        return lines


class NotAnswered(NotAProgram):
    """The class that belongs into the program is not written yet."""


def fill_in(cell: str) -> str:
    """Return the cell's text, with each `class Name(Node): ...` replaced by the notebook's class.

    Raises NotAnswered if a class is missing or does nothing, and NotAProgram if the cell is not
    valid Python, or the program needs names that only the notebook has.
    """
    try:
        tree = ast.parse(cell)
    except SyntaxError as error:
        # +1: in the student's cell, the magic command is the first line
        lineno = (error.lineno or 0) + 1
        where = f'line {lineno}: {error.msg}'
        raise NotAProgram(f'this cell is not valid Python ({where}): fix that line') from None
    lines = cell.splitlines(keepends=True)
    for node in reversed(tree.body):
        if isinstance(node, ast.ClassDef) and _is_left_open(node):
            lines[node.lineno - 1 : node.end_lineno] = [_source_of(node.name)]
    program = ''.join(lines)
    if missing := names_missing_in(program):
        raise NotAProgram(_how_to_add(missing))
    return program


def names_missing_in(program: str) -> list[str]:
    """Return the global names that a program reads and does not bind, sorted.

    Returns [] if there is a star import, which may bind any name.
    """
    if any(isinstance(n, ast.ImportFrom) and n.names[0].name == '*' for n in _nodes(program)):
        return []
    bound, read = set(), set()
    tables = [symtable.symtable(program, 'program', 'exec')]
    while tables:
        table = tables.pop()
        for symbol in table.get_symbols():
            if table.get_type() == 'module' or symbol.is_global():
                if symbol.is_assigned() or symbol.is_imported():
                    bound.add(symbol.get_name())
                if symbol.is_referenced():
                    read.add(symbol.get_name())
        tables += table.get_children()
    return sorted(read - bound - _EVERYWHERE)


def _nodes(program: str) -> Iterable[ast.AST]:
    return ast.walk(ast.parse(program))


def _is_left_open(node: ast.ClassDef) -> bool:
    [*_, last] = node.body
    return len(node.body) == 1 and isinstance(last, ast.Expr) and _is_ellipsis(last.value)


def _is_ellipsis(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is ...


def _source_of(name: str) -> str:
    """Return the text of the notebook's class of that name, as it was typed."""
    found = vars(sys.modules['__main__']).get(name)
    if found is None:
        raise NotAnswered(
            f'there is no class {name} yet: run the cell in which you write it, then this one'
        )
    if not isinstance(found, type) or found.__module__ != '__main__':
        raise NotAProgram(f'{name} is not a class of this notebook: write your own, and run it')
    text, node = _definition(found)
    if _does_nothing(node):
        raise NotAnswered(
            f'{name} does nothing yet: answer the exercise, run its cells, then this one'
        )
    first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
    lines = text.splitlines(keepends=True)[first - 1 : node.end_lineno]
    return textwrap.dedent(''.join(lines)).rstrip('\n') + '\n'


def _definition(NodeClass: type) -> tuple[str, ast.ClassDef]:
    """Return the text of the cell that defined a class, and the class in its syntax tree.

    Before Python 3.13, `inspect.getsource` needs a file; but a method's code has its cell's name.
    """
    methods = [m for m in vars(NodeClass).values() if isinstance(m, FunctionType)]
    for method in methods:
        text = ''.join(linecache.getlines(method.__code__.co_filename))
        classes = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.ClassDef)]
        if found := [n for n in classes if n.name == NodeClass.__name__]:
            return text, found[-1]
    raise NotAProgram(
        f'the text of {NodeClass.__name__} was not found: put the class itself, with its methods, '
        'in place of the ... in this cell'
    )


def _does_nothing(node: ast.ClassDef) -> bool:
    """Whether a class only calls Node's constructor, as an unanswered exercise does."""
    if [ast.unparse(base) for base in node.bases] != ['Node']:
        return False  # its base class may do everything that is needed
    calls = [ast.unparse(n.func) for n in ast.walk(node) if isinstance(n, ast.Call)]
    return set(calls) <= {'super', 'super().__init__'}


def _how_to_add(names: list[str]) -> str:
    notebook = vars(sys.modules['__main__'])
    lines = []
    for name in names:
        if name in ONLY_IN_NOTEBOOKS:
            lines.append(f'{name}: only a notebook has it; leave it out, as well as ! and %')
        elif name not in notebook:
            lines.append(f'{name}: no cell defines it; correct the name')
        elif line := import_line(name, notebook[name]):
            lines.append(f'{name}: add the line   {line}')
        else:
            lines.append(f'{name}: copy its definition to a line above the class')
    first = (
        'the program would not know these names, because a file sees only what is in it. '
        'Change this cell as follows, then run it again:'
    )
    return '\n'.join([first, *(f'{INDENT}{line}' for line in lines)])


def import_line(name: str, thing: Any) -> str:
    """Return the line that imports a thing under that name; '' if there is none."""
    if isinstance(thing, ModuleType):
        return f'import {thing.__name__}' + (f' as {name}' if name != thing.__name__ else '')
    own = getattr(thing, '__name__', None)
    parts = (getattr(thing, '__module__', None) or '').split('.')
    # sensor_msgs.msg._joint_state is private: sensor_msgs.msg exports the same class
    public = '.'.join(part for part in parts if not part.startswith('_'))
    for module in (public, '.'.join(parts)):
        if own and module != '__main__' and getattr(sys.modules.get(module), own, None) is thing:
            return f'from {module} import {own}' + (f' as {name}' if name != own else '')
    return ''
