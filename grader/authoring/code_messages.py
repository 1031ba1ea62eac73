"""Find the sentences in code that people read: the templates of its string literals.

`f'no message in {seconds:g} s'` is the template `no message in {seconds} s`. If the code chooses
between two words for a placeholder, the words are found separately.
"""

import ast
import re
from collections.abc import Collection, Iterator

_WORDS = re.compile(
    r"[^\W\d_]{2,}'?[,;:]?\s+[^\W\d_{]|\} [^\W\d_]{2,}|[^\W\d_]{2,}:? +\{|\{\w+\}, "
    r'|\}: [^\W\d_]{4,}'
)
_NOISE = re.compile(
    r'^\s*(import|from|cd) |^(\$ |<pre|margin:|course: |build(/| install)|spin \{)'
    r'|\n {4}|\\w|\(\?|^\s*[\w/.]+\s*$|%s|\{\w+!r\}'
    r'|^("""|__import__\(|QoSProfile\(|rcl_|\./course [\w-]+$| as \{\w+\}$)'
    r'|^\w+: \{in_language_here\}$'
)
_NOT_READ = {'TypeError', 'ValueError', 'KeyError', 'AttributeError', 'RuntimeError', 'compile'}
_NOT_READ |= {'expect_names', 'expect_definitions'}
_NOT_READ |= {'AssertionError', 'startswith', 'endswith'}
"""Functions and exceptions whose texts are not translated: errors in our own code, patterns, lines
of ROS interface definitions, and texts to search for."""
_CODE = {'code', 'usage', 'prog', 'pattern'}
"""Arguments that are not translated: users type them, or, as patterns, never see them."""
_NO_WORDS = {'true', 'false', 'markdown', 'demo', 'setup', 'free'}
"""Words of Python, ROS and nbformat that code chooses between; they are not shown."""

_WORD = re.compile(r'[^\W\d_A-Z][\w, ]+')
_TOLD = {'expected', 'seen', 'hint', 'cause'}
"""Arguments of a failing check's message."""


def messages_in(source: str, *, title: bool = False) -> list[str]:
    """Return the templates of a module's or cell's sentences, in order, each once.

    With `title`, the first lines of its docstring and its functions' docstrings are included: the
    titles of a check and of an experiment's parts.
    """
    tree = ast.parse(source)
    found = [_without_note(text) for text in _visit(tree) if not _NOISE.search(text)]
    told: list[ast.Module | ast.FunctionDef] = [tree]
    told += [each for each in tree.body if isinstance(each, ast.FunctionDef)]
    for node in told:
        if title and (docstring := ast.get_docstring(node)):
            found.append(docstring.partition('\n')[0])
    words = (word for node in ast.walk(tree) for word in _shown_words(node))
    return list(dict.fromkeys([*found, *words]))


def alt_text_messages_in(source: str) -> list[str]:
    """Return the templates that a module marks by gettext_noop: parts of alternative texts."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    marked = [call.args[0] for call in calls if _called(call) == 'gettext_noop']
    marked.sort(key=lambda text: (text.lineno, text.col_offset))
    return [_template(text)[0] for text in marked]


def texts_passed_to(source: str, callers: Collection[str]) -> list[str]:
    """Return the texts that a module passes to a function of one of these names, in order."""
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    first = [call.args[0] for call in calls if call.args and _called(call) in callers]
    return [str(text.value) for text in first if isinstance(text, ast.Constant)]


def _without_note(text: str) -> str:
    """Return a text without the prefix of a note, which is not shown."""
    rest = text.removeprefix('note: ')
    return rest if _WORDS.search(rest) else text


def _visit(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring, or a comment
    if isinstance(node, ast.Call) and _called(node) in _NOT_READ:
        return
    if isinstance(node, ast.keyword) and node.arg in _CODE:
        return
    if _is_text(node):
        template, places = _template(node)
        if _WORDS.search(template):
            yield template
        for place in places:
            yield from _visit(place)
        return
    for child in ast.iter_child_nodes(node):
        yield from _visit(child)


def _shown_words(node: ast.AST) -> Iterator[str]:
    """Yield single words that are shown.

    They are those that code chooses between, and what a check expected or saw. A word needs
    several letters, so the s of a plural is left out.
    """
    if isinstance(node, ast.IfExp):
        yield from _words_of(node)
    if isinstance(node, ast.AnnAssign | ast.AugAssign) and _name(node.target) == 'TO_SHOW':
        texts = ast.walk(node.value or node)
        yield from (str(text.value) for text in texts if isinstance(text, ast.Constant))
    if isinstance(node, ast.Call):
        told = [each.value for each in node.keywords if each.arg in _TOLD]
        yield from _words_of(*told)
        yield from (
            text.value
            for text in told
            if isinstance(text, ast.Constant) and isinstance(text.value, str)
        )


def _words_of(*expressions: ast.AST) -> Iterator[str]:
    for expression in expressions:
        if isinstance(expression, ast.IfExp):
            yield from _words_of(expression.body, expression.orelse)
        elif isinstance(expression, ast.BoolOp):
            yield from _words_of(*expression.values)
        elif isinstance(expression, ast.Constant):
            word = str(expression.value)
            if _WORD.fullmatch(word) and word not in _NO_WORDS:
                yield word


def _is_text(node: ast.AST) -> bool:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return _is_text(node.left) or _is_text(node.right)
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _template(node: ast.AST) -> tuple[str, list[ast.AST]]:
    """Return a text with a name for each placeholder, and the expressions of the placeholders."""
    names: list[str] = []
    places: list[ast.AST] = []

    def place(expression: ast.AST) -> str:
        plain = name = _name(expression)
        while name in names:
            name = f'{plain}{len(names) + 1}'
        names.append(name)
        places.append(expression)
        return f'{{{name}}}'

    def text(part: ast.AST) -> str:
        if isinstance(part, ast.Constant):
            return str(part.value)
        if isinstance(part, ast.JoinedStr):
            return ''.join(map(text, part.values))
        if isinstance(part, ast.FormattedValue):
            return place(part.value)
        if isinstance(part, ast.BinOp) and isinstance(part.op, ast.Add):
            return text(part.left) + text(part.right)
        return place(part)

    return text(node), places


def _name(expression: ast.AST) -> str:
    """Return the name of a placeholder: its variable, attribute or function."""
    if isinstance(expression, ast.Call):
        return _called(expression).strip('_') or 'value'
    if isinstance(expression, ast.Subscript):
        return _name(expression.value)
    if isinstance(expression, ast.Attribute):
        return expression.attr.strip('_')
    return expression.id.strip('_') if isinstance(expression, ast.Name) else 'value'


def _called(call: ast.Call) -> str:
    function = call.func
    return getattr(function, 'attr', getattr(function, 'id', ''))
