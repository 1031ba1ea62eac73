"""What a test replaces in a module is there: a slow test of a name that has moved fails unseen."""

import ast
import importlib
from pathlib import Path

import pytest

HERE = Path(__file__).parent
OURS = ('grader', 'launcher', 'my_robot_basics')
FILES = sorted(path for path in HERE.glob('*.py') if 'monkeypatch.setattr(' in path.read_text())


def imported(tree):
    """Return what a file knows of ours: the full name of each module, or of what is in one."""
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
def test_what_a_test_replaces_is_there(path):
    assert [name for name in patched(ast.parse(path.read_text())) if not is_there(name)] == []


def test_a_name_that_has_moved_is_found():
    text = "from my_robot_basics.checks import passage\nmonkeypatch.setattr(passage, 'NEVER', 1)"
    (name,) = patched(ast.parse(text))
    assert name == 'my_robot_basics.checks.passage.NEVER'
    assert not is_there(name)
    assert is_there('my_robot_basics.checks.passage.time.time_ns')
