"""Which names a cell binds, and which it needs from elsewhere: read from its text, never run."""

import ast
import builtins
import re
import symtable
from dataclasses import dataclass
from functools import lru_cache

from IPython.core.inputtransformer2 import TransformerManager

MAX_SOURCE_CHARACTERS = 20_000
"""Ten times the longest answer. Some texts take a time that grows with the square of it."""
MAX_IPYTHON = {'characters': 4_000, 'lines': 10}
"""The same for text that is not Python without IPython's help: it reads all for each magic."""


@dataclass(frozen=True)
class Names:
    """The global names of one cell."""

    bound: frozenset[str] = frozenset()
    needed: frozenset[str] = frozenset()
    """Read somewhere in the cell, in its functions too, bound nowhere in it, and no builtin."""
    binds_more: bool = False
    """Whether a star import binds names that its text does not tell."""
    needs_more: bool = False
    """Whether it looks names up by other means than its text: `eval`, `globals()`, `__main__`."""


@lru_cache(maxsize=1_000)
def names_of(source: str) -> Names:
    """Read a cell's global names; a cell that does not parse has none."""
    if len(source) > MAX_SOURCE_CHARACTERS:
        return Names()
    try:
        code, tree = _python(source)
        table = symtable.symtable(code, 'cell', 'exec')
        nodes = list(ast.walk(tree))
    except (SyntaxError, ValueError, RuntimeError, MemoryError):  # a RecursionError, too
        return Names()
    bound: set[str] = set()
    read: set[str] = set()
    _collect(table, bound, read)
    loop_names = _names_of_comprehensions_alone(nodes)
    return Names(
        bound=frozenset(bound - loop_names),
        needed=frozenset(read - bound - vars(builtins).keys() - _IPYTHON),
        binds_more=any(isinstance(n, ast.ImportFrom) and n.names[0].name == '*' for n in nodes),
        needs_more=any(_said(node) & _LOOK_UP for node in nodes),
    )


def names_not_defined(said: str) -> set[str]:
    """Return the names that errors in a text say are not there."""
    return {name for names in _NOT_DEFINED.findall(said) for name in names if name}


def string_arguments(source: str, function: str) -> tuple[str, ...]:
    """Return the literal string arguments of a cell's calls of `function`."""
    return tuple(
        argument.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Call) and getattr(node.func, 'id', None) == function
        for argument in node.args
        if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
    )


_NOT_DEFINED = re.compile(
    r"NameError: name '(\w+)' is not defined|KeyError: '(\w+)'"
    r"|AttributeError: module '__main__' has no attribute '(\w+)'"
)
_LOOK_UP = frozenset(('eval', 'exec', 'globals', 'locals', 'vars', '__main__', 'user_ns'))
"""Names, modules, attributes and texts that lead to names which a text does not tell."""


def _said(node: ast.AST) -> set[str]:
    """Return what a node names: a name, an attribute, a module, a text."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.Constant(value=str(name)):
            return {name}
        case ast.Import(names=names):
            return {alias.name for alias in names}
        case ast.ImportFrom(module=str(name), names=names):
            return {name, *(alias.name for alias in names)}
    return set()


_MAGIC = re.compile(r'^\s*[!%?,;/]|\?\s*$|=\s*[!%]', re.MULTILINE)
_IPYTHON = {'display', 'get_ipython', 'In', 'Out', '_', '__', '___', '__name__', '__file__'}


class _Transformer(TransformerManager):
    """IPython's, which gives up sooner: it reads all text anew for each `;` of a thousand."""

    def do_token_transforms(self, lines: list[str]) -> list[str]:
        """Replace what only IPython understands. Raises SyntaxError where it is too much."""
        for _ in range(MAX_IPYTHON['lines'] + 1):
            changed, lines = self.do_one_token_transform(lines)
            if not changed:
                return lines
        raise SyntaxError('too much of it is what only IPython understands')


def _python(source: str) -> tuple[str, ast.Module]:
    """Return a cell as plain Python. Raises SyntaxError, and what else `ast.parse` does."""
    try:
        return source, ast.parse(source)
    except SyntaxError:
        lines = len(_MAGIC.findall(source))
        if len(source) > MAX_IPYTHON['characters'] or lines > MAX_IPYTHON['lines']:
            raise
    code = _Transformer().transform_cell(source)
    return code, ast.parse(code)


def _collect(outermost: symtable.SymbolTable, bound: set[str], read: set[str]) -> None:
    tables = [outermost]
    while tables:  # not by recursion: a table lies in a table for each `lambda:` of a thousand
        table = tables.pop()
        is_module = table.get_type() == 'module'
        for symbol in table.get_symbols():
            is_global = is_module or symbol.is_global()
            if is_global and (symbol.is_assigned() or symbol.is_imported()):
                bound.add(symbol.get_name())
            if is_global and symbol.is_referenced():
                read.add(symbol.get_name())
        tables.extend(table.get_children())


def _names_of_comprehensions_alone(nodes: list[ast.AST]) -> set[str]:
    """Names that only comprehensions bind: from Python 3.12 on, symtable tells them as ours."""
    targets = [n.target for n in nodes if isinstance(n, ast.comprehension)]
    inside = {id(n) for target in targets for n in ast.walk(target)}
    stored = [n for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)]
    elsewhere = {n.id for n in stored if id(n) not in inside}
    return {n.id for n in stored if id(n) in inside} - elsewhere
