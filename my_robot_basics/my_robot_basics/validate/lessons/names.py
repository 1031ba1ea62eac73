"""Which names a cell binds, and which it needs from other cells; its text is parsed, not run."""

import ast
import builtins
import re
import symtable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeGuard

from IPython.core.inputtransformer2 import TransformerManager

MAX_SOURCE_CHARACTERS = 20_000
"""Ten times the longest answer: for some texts, the time grows with the square of the length."""
MAX_IPYTHON = {'characters': 4_000, 'lines': 10}
"""Limits for text with IPython's syntax: IPython reads all of it again for each magic."""


@dataclass(frozen=True)
class Names:
    """The global names of one cell."""

    bound: frozenset[str] = frozenset()
    needed: frozenset[str] = frozenset()
    """Names that the cell or its functions read, but that running the cell does not bind.

    Builtins are left out. A global that only a function binds is needed: it may be called late.
    """
    binds_more: bool = False
    """Whether it may bind names that its text does not show: a star import, `%run`, `exec`, …"""
    needs_more: bool = False
    """Whether it may read names that its text does not show: `eval`, `globals()`, `__main__`."""


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
    here, later, read = _globals(table)
    # from Python 3.12 on, symtable does not report that `[y := x for x in z]` binds y
    walrus = {node.target.id for node in nodes if isinstance(node, ast.NamedExpr)}
    here |= walrus & {*table.get_identifiers()}
    stored, loaded = _said_to_bind_and_read(nodes)
    there = here & stored | vars(builtins).keys() | _IPYTHON
    needs_more = any(_named_in(node) & _LOOK_UP for node in nodes)
    imports_all = any(isinstance(n, ast.ImportFrom) and n.names[0].name == '*' for n in nodes)
    return Names(
        bound=frozenset((here | later) & stored),
        needed=frozenset((here | later | read) & loaded - there),
        binds_more=imports_all or needs_more or bool(_RUN.search(source)),
        needs_more=needs_more,
    )


def names_not_defined(said: str) -> set[str]:
    """Return the names that a text with error messages reports as undefined."""
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
"""Names, modules, attributes and strings with which code reads names not shown in its text."""


def _named_in(node: ast.AST) -> set[str]:
    """Return the name, attribute, modules or string constant that a syntax node contains."""
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name) | ast.Constant(value=str(name)):
            return {name}
        case ast.Import(names=names):
            return {alias.name for alias in names}
        case ast.ImportFrom(module=str(name), names=names):
            return {name, *(alias.name for alias in names)}
    return set()


_AT_ONCE = ('listcomp', 'setcomp', 'dictcomp')
_RUN = re.compile(r'^[ \t]*%run\s', re.MULTILINE)
_AROUND_CELL = re.compile(r'\A\s*%%(?:time|capture|prun)\b.*\n')
_BEFORE_LINE = re.compile(r'^([ \t]*)%(?:time|prun)[ \t]+(?=[^\W\d])', re.MULTILINE)
"""Magics that run the Python code after them as if they were not there."""
_MAGIC = re.compile(r'^[ \t]*[!%?,;/]|\?\s*$|=\s*[!%]', re.MULTILINE)
_IPYTHON = {'display', 'get_ipython', 'In', 'Out', '_', '__', '___', '__name__', '__file__'}


class _Transformer(TransformerManager):
    """IPython's transformer with a limit: it reads all text again for each `;` or magic."""

    def do_token_transforms(self, lines: list[str]) -> list[str]:
        """Replace IPython's syntax by Python. Raises SyntaxError after too many replacements."""
        for _ in range(MAX_IPYTHON['lines'] + 1):
            changed, lines = self.do_one_token_transform(lines)
            if not changed:
                return lines
        raise SyntaxError('too much of it is what only IPython understands')


def _python(source: str) -> tuple[str, ast.Module]:
    """Return a cell as plain Python, and its syntax tree. Raises what `ast.parse` raises."""
    try:
        return source, ast.parse(source)
    except SyntaxError:
        if len(source) > MAX_IPYTHON['characters']:
            raise
        if len(_MAGIC.findall(source)) > MAX_IPYTHON['lines']:
            raise
    source = _BEFORE_LINE.sub(r'\1', _AROUND_CELL.sub('', source))
    code = _Transformer().transform_cell(source)
    return code, ast.parse(code)


def _globals(outermost: symtable.SymbolTable) -> tuple[set[str], set[str], set[str]]:
    """Return the global names that running the cell binds, that its functions bind, and read."""
    here: set[str] = set()
    later: set[str] = set()
    read: set[str] = set()
    tables = [(outermost, here)]
    while tables:  # no recursion: a thousand nested `lambda:` would exceed its limit
        table, bound = tables.pop()
        for symbol in table.get_symbols():
            if table.get_type() == 'module' or symbol.is_global():
                if symbol.is_assigned() or symbol.is_imported():
                    bound.add(symbol.get_name())
                if symbol.is_referenced():
                    read.add(symbol.get_name())
        for child in table.get_children():
            runs_at_once = child.get_type() == 'class' or child.get_name() in _AT_ONCE
            tables.append((child, bound if runs_at_once else later))
    return here, later, read


def _said_to_bind_and_read(nodes: list[ast.AST]) -> tuple[set[str], set[str]]:
    """Return the names of all scopes that are bound, and those that are read."""
    aside = _inside_comprehensions(nodes)
    aside |= {id(n.target) for n in nodes if isinstance(n, ast.AnnAssign) and n.value is None}
    added_to = {id(n.target) for n in nodes if isinstance(n, ast.AugAssign)}
    bound: set[str] = set()
    read: set[str] = set()
    for node in nodes:
        match node:
            case ast.Name() if id(node) in aside:
                pass
            case ast.Name(id=name, ctx=ast.Store()) if id(node) not in added_to:
                bound.add(name)
            case ast.Name(id=name):
                read.add(name)
            case ast.alias(name=name, asname=other):
                bound.add((other or name).partition('.')[0])
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name):
                bound.add(name)
            case ast.ClassDef(name=name) | ast.ExceptHandler(name=str(name)):
                bound.add(name)
            case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)):
                bound.add(name)
            case ast.MatchMapping(rest=str(name)):
                bound.add(name)
    return bound, read


def _inside_comprehensions(nodes: list[ast.AST]) -> set[int]:
    """Return the ids of Name nodes, inside a comprehension, of names that it binds itself.

    From Python 3.12 on, symtable reports such names for the scope around the comprehension.
    """
    found: set[int] = set()
    for node in nodes:
        if loops := getattr(node, 'generators', None):
            inside = [n for part in (node, *loops) for n in ast.iter_child_nodes(part)]
            parts = [n for n in inside if n is not loops[0].iter and n not in loops]
            names = [n for part in parts for n in ast.walk(part) if isinstance(n, ast.Name)]
            targets = {n.id for each in loops for n in ast.walk(each.target) if _is_stored(n)}
            found |= {id(n) for n in names if n.id in targets}
    return found


def _is_stored(node: ast.AST) -> TypeGuard[ast.Name]:
    return isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
