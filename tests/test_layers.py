"""Imports go one way, inside of functions too, and no module takes another's private names."""

import ast
import graphlib
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

import grader
import my_robot_basics
from my_robot_basics import checks, live, validate

ROOT = Path(__file__).parents[1]
PACKAGES = {
    'grader': ROOT / 'grader',
    'my_robot_basics': ROOT / 'my_robot_basics' / 'my_robot_basics',
}
PROGRAM = 'grader.kernels.forkserver.'
"""Run by its folder, so its modules know each other by their own names."""


@cache
def modules():
    """Return the code of each module, parsed, by its name."""
    return {
        '.'.join((package, *path.relative_to(folder).with_suffix('').parts)).removesuffix(
            '.__init__'
        ): ast.parse(path.read_text(encoding='utf-8'))
        for package, folder in PACKAGES.items()
        for path in sorted(folder.rglob('*.py'))
    }


def imported(module):
    """Yield what a module imports of ours, in functions too: the module, and the name in it.

    What only a type checker imports does not count.
    """
    beside = PROGRAM if module.startswith(PROGRAM) else ''
    for node in nodes(modules()[module]):
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                whole = f'{beside}{node.module}.{alias.name}'
                yield (whole, '') if whole in modules() else (beside + node.module, alias.name)
        elif isinstance(node, ast.Import):
            yield from ((beside + alias.name, '') for alias in node.names)


def nodes(tree):
    for node in ast.iter_child_nodes(tree):
        if not (isinstance(node, ast.If) and getattr(node.test, 'id', '') == 'TYPE_CHECKING'):
            yield node
            yield from nodes(node)


def test_no_modules_import_each_other_in_a_circle():
    needs = {
        module: {other for other, _ in imported(module) if other in modules() and other != module}
        for module in modules()
    }
    assert needs['grader.__main__'] >= {'grader.cli.arguments', 'grader.course'}
    assert needs[f'{PROGRAM}__main__'] >= {f'{PROGRAM}privilege_drop'}
    graphlib.TopologicalSorter(needs).prepare()  # raises CycleError, which names them


def test_private_names_of_a_module_are_imported_nowhere():
    taken = [
        (module, f'{other}.{name}')
        for module in modules()
        for other, name in imported(module)
        if other in modules() and any(p.startswith('_') for p in f'{other}.{name}'.split('.'))
    ]
    assert taken == []


LAYERED = pytest.mark.parametrize(
    'package', [grader, my_robot_basics, checks, live, validate], ids=lambda p: p.__name__
)


def layer(module, package):
    """Return the part of a package that a module belongs to, or ''."""
    name = f'{package.__name__}.'
    return module.removeprefix(name).split('.')[0] if module.startswith(name) else ''


@LAYERED
def test_parts_of_a_package_import_only_from_lower_layers(package):
    upward = [
        f'{module} imports {other}'
        for module in modules()
        for other, _ in imported(module)
        if layer(module, package) and layer(other, package)
        if package.LAYERS.index(layer(module, package))
        < package.LAYERS.index(layer(other, package))
    ]
    assert upward == []


@LAYERED
def test_each_part_of_a_package_has_its_line_in_the_docstring(package):
    parts = {layer(module, package) for module in modules()} - {''}
    assert sorted(parts) == sorted(package.LAYERS)
    assert set(re.findall(r'`(\w+)`', package.__doc__)) >= parts - {'__main__'}
    rows = set(re.findall(r'^- `(\w+)`: ', package.__doc__, re.M))
    assert parts >= rows > set()


def test_the_students_package_imports_nothing_of_the_grader():
    ours = [module for module in modules() if module.startswith('my_robot_basics')]
    assert [m for m in ours for other, _ in imported(m) if other.startswith('grader')] == []


def test_a_file_of_tests_imports_nothing_from_another_file_of_tests():
    """Shared code is in a helper, such as tests/lab_browser.py, or in a fixture of conftest.py."""
    helpers = {path.stem for path in (ROOT / 'tests').glob('*.py')}
    tests = {name for name in helpers if name.startswith('test_')}
    taken = [
        (name, node.module)
        for name in sorted(helpers)
        for node in ast.walk(ast.parse((ROOT / 'tests' / f'{name}.py').read_text('utf-8')))
        if isinstance(node, ast.ImportFrom) and node.module in tests
    ]
    assert len(tests) > 200
    assert taken == []


MOST_LINES = 200


def product():
    """Return the files of all that is not a test."""
    folders = [*PACKAGES.values(), ROOT / 'launcher']
    return sorted(path for folder in folders for path in folder.rglob('*.py'))


def test_no_module_is_longer_than_two_hundred_lines():
    """A longer module has two subjects: give each subject a module and a name."""
    lines = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding='utf-8').splitlines())
        for path in product()
    }
    assert len(lines) > 300
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_no_two_public_classes_have_the_same_name():
    """Two classes of one name are two things with the same name, or one thing twice.

    A protocol and what implements it have two names, too: GradingRooms and LocalRooms are Rooms.
    """
    places = defaultdict(list)
    for path in product():
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith('_'):
                places[node.name].append(str(path.relative_to(ROOT)))
    assert len(places) > 100
    assert {name: paths for name, paths in places.items() if len(paths) > 1} == {}
