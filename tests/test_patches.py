"""Names that tests patch exist: if a name has moved, a slow test would fail unnoticed."""

import ast
import importlib
from pathlib import Path

import pytest

HERE = Path(__file__).parent
OURS = ('grader', 'launcher', 'my_robot_basics')
FILES = sorted(path for path in HERE.glob('*.py') if 'monkeypatch.setattr(' in path.read_text())


def imported(tree):
    """Return the full names of our modules, and of names from them, that a file imports."""
    known = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or '').split('.')[0] in OURS:
            known |= {a.asname or a.name: f'{node.module}.{a.name}' for a in node.names}
        elif isinstance(node, ast.Import):
            known |= {a.asname: a.name for a in node.names if a.asname}
    return known


def patched(tree):
    """Yield the full name of each attribute that `monkeypatch.setattr` is to replace in ours."""
    known = imported(tree)
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and ast.unparse(node.func) == 'monkeypatch.setattr'):
            continue
        target, *others = node.args
        if isinstance(target, ast.Constant):
            name = target.value
        elif isinstance(others[0], ast.Constant):
            first, dot, rest = ast.unparse(target).partition('.')
            name = f'{known.get(first, "")}{dot}{rest}.{others[0].value}'
        else:
            continue
        if name.split('.')[0] in OURS:
            yield name


def is_there(name):
    """Whether a module, or something in it, has that attribute."""
    parts = name.split('.')
    for count in range(len(parts) - 1, 0, -1):
        try:
            thing = importlib.import_module('.'.join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for part in parts[count:-1]:
            thing = getattr(thing, part, None)
        return hasattr(thing, parts[-1])
    return False


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_each_name_that_a_test_patches_exists(path):
    assert [name for name in patched(ast.parse(path.read_text())) if not is_there(name)] == []


def test_a_patched_name_that_does_not_exist_is_found():
    text = (
        'from my_robot_basics.checks.relays import passage\n'
        "monkeypatch.setattr(passage, 'NEVER', 1)"
    )
    (name,) = patched(ast.parse(text))
    assert name == 'my_robot_basics.checks.relays.passage.NEVER'
    assert not is_there(name)
    assert is_there('my_robot_basics.checks.relays.passage.time.time_ns')
