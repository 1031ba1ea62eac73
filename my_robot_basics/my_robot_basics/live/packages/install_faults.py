"""Why `ros2 run` cannot use what a build has installed, in a sentence with a hint."""

import ast
import difflib
import os
import sys
from collections.abc import Iterator
from importlib.metadata import Distribution, EntryPoint
from pathlib import Path

from my_robot_basics.live.packages.package_faults import NO_PYTHON, short
from my_robot_basics.session.package_files import PackageFiles

_MOST_OF_A_LINE = 200
"""Bytes of an executable's first line that are read."""


def fault_in_install(package: str, prefix: Path, files: PackageFiles) -> str:
    """Say why `ros2 run` cannot run what was installed; '' if it can."""
    if not (prefix / 'share/ament_index/resource_index/packages' / package).is_file():
        return (
            f'{package} was built without its marker, so that ROS does not find it: install '
            f"('share/ament_index/resource_index/packages', ['resource/{package}']) by data_files "
            'of setup.py'
        )
    entries = list(_entry_points(package, prefix))
    scripts = prefix / 'lib' / package
    if not entries and not (scripts.is_dir() and any(scripts.iterdir())):
        return (
            f'{package} was built, and has no executable: name one in entry_points of setup.py, '
            f"{{'console_scripts': ['NAME = {package}.MODULE:main']}}"
        )
    if entries and not scripts.is_dir():
        others = (path.name for path in sorted((prefix / 'lib').iterdir()))
        place = next((f'lib/{name}' for name in others if not name.startswith('python')), 'bin')
        return (
            f'the executables of {package} are in {short(place)}/, where `ros2 run` does not '
            'look: write into setup.cfg, below [install], '
            f'install_scripts=$base/lib/{package}'
        )
    site = prefix / 'lib/python{}.{}/site-packages'.format(*sys.version_info)
    faults = (_fault_of_entry(entry, package, site, files) for entry in entries)
    return next(filter(None, faults), '') or _fault_of_scripts(scripts)


def _fault_of_scripts(scripts: Path) -> str:
    """Say why Linux cannot start an executable; '' if it can start all of them.

    setuptools writes `#!python` into files of `scripts=`, which only a wheel's installer replaces.
    """
    for path in sorted(scripts.iterdir()):
        line = _first_line(path)
        words = line.removeprefix('#!').split()
        if line.startswith('#!') and words and not Path(words[0]).is_file():
            return (
                f'{short(path.name)} begins with {short(line)!r}, and there is no such program, '
                'so `ros2 run` cannot start it: name a function in entry_points of setup.py, and '
                'leave scripts= out'
            )
    return ''


def _first_line(path: Path) -> str:
    """Return the first line of an executable; '' if it is not a readable file."""
    if not path.is_file():
        return ''
    try:
        with path.open('rb') as file:
            return os.fsdecode(file.readline(_MOST_OF_A_LINE))
    except OSError:
        return ''


def _entry_points(package: str, prefix: Path) -> Iterator[EntryPoint]:
    site = prefix / 'lib/python{}.{}/site-packages'.format(*sys.version_info)
    for info in sorted([*site.glob('*.egg-info'), *site.glob('*.dist-info')]):
        entries = Distribution.at(info).entry_points
        scripts = (entry for entry in entries if entry.group == 'console_scripts')
        yield from (entry for entry in scripts if entry.pattern.match(entry.value))


def _fault_of_entry(entry: EntryPoint, package: str, site: Path, files: PackageFiles) -> str:
    line = short(f'{entry.name} = {entry.value}')
    if not entry.attr:
        return (
            f'entry_points of setup.py has {line!r}, which names no function: write a colon and '
            f'the function after the module, {package}.MODULE:main'
        )
    if entry.module.endswith('.py'):
        return f'entry_points of setup.py has {line!r}: leave out .py, a module has no such ending'
    path = entry.module.replace('.', '/')
    names = (f'{path}.py', f'{path}/__init__.py')
    top = entry.module.partition('.')[0]
    short_of = ''
    if f'{package}/{path}.py' in files.taken:
        short_of = (
            f'entry_points of setup.py has {line!r}, and that module is in the package {package}: '
            f'write {package}.{entry.module}:{entry.attr}'
        )
    is_installed = (site / top).exists() or (site / f'{top}.py').exists()  # also by py_modules
    if not is_installed and top not in {name.partition('/')[0] for name in files.taken}:
        return short_of or (
            f'entry_points of setup.py has {line!r}, and there is no package {top}: correct it'
        )
    here = next((site / name for name in names if (site / name).is_file()), None)
    if here is None:
        if any(name in files.taken for name in names):
            return (
                f'{names[0]} was not installed, and {entry.name} needs it: put an empty '
                f'__init__.py into {path.rpartition("/")[0]}/, and name that folder in packages= '
                'of setup.py'
            )
        return (
            f'entry_points of setup.py has {line!r}, and there is no {names[0]}: write that '
            'module, or correct the name'
        )
    try:
        tree = ast.parse(here.read_bytes())
    except (SyntaxError, *NO_PYTHON) as error:
        line_number = getattr(error, 'lineno', None)
        said = f'line {line_number}: {error.msg}' if isinstance(error, SyntaxError) else error
        return f'{names[0]} is not valid Python ({said}): fix that, and build again'
    function = entry.attr.partition('.')[0]
    if function in set(_bound(tree)):
        return ''
    if short_of:
        return short_of
    functions = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
    close = [name for name in functions if name.lower() == function.lower()]
    for meant in [*close, *difflib.get_close_matches(function, functions)][:1]:
        return (
            f'entry_points of setup.py has {line!r}, and {names[0]} has no function {function}: '
            f'write {meant} in its place'
        )
    return (
        f'entry_points of setup.py has {line!r}, and {names[0]} has no function {function}: write '
        f'`def {function}(args=None):` there'
    )


def _bound(tree: ast.Module) -> Iterator[str]:
    """Yield names that a module may bind; those of `from … import *` are unknown."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            yield node.name
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.alias):
            yield node.asname or node.name.partition('.')[0]
