"""Add an entry point, with which `ros2 run` starts a function of the student's package."""

import ast
import re
from pathlib import Path

from my_robot_basics.live.packages import workspace
from my_robot_basics.session.errors import LiveError, tell

_FORM = re.compile(r'(?P<command>[\w-]+) *= *(?P<package>\w+)\.(?P<module>\w+):(?P<function>\w+)')


class NotAdded(LiveError):
    """An entry point does not fit the package, or `setup.py` has no list of entry points."""


def add_entry_point(entry_point: str) -> None:
    """Add a line such as 'greeter = my_robot_basics.greeter:main' to `setup.py`; show the list.

    The rest of `setup.py` stays as it is. If the module is not written yet, this is printed.
    Raises NotAdded if the module lacks the function, another function has the command's name, or
    the list is not found.
    """
    command, module, name = _parse_entry_point(entry_point)
    if not module.is_file():  # no exception, so that *Run All* continues
        said = f'not added: there is no {workspace.ros_ws_path(module)} yet: run the cell with'
        tell(f'{said} %%write_node {module.name} first', in_one=False)
        return
    _expect_function(module, name)
    setup_file = workspace.package_folder() / 'setup.py'
    if not setup_file.is_file():
        raise NotAdded(
            f'there is no {workspace.ros_ws_path(setup_file)}: run the cell with make_workspace() '
            'first'
        )
    text = setup_file.read_text(encoding='utf-8')
    listed = _find_console_scripts(_parse(setup_file))
    if listed is None:
        raise NotAdded(
            f"{workspace.ros_ws_path(setup_file)} has no list 'console_scripts' any more: add "
            f"'{entry_point}' yourself where it belongs (reference/ has the file as it was)"
        )
    constants = [e.value for e in listed.elts if isinstance(e, ast.Constant)]
    entries = [value for value in constants if isinstance(value, str)]
    taken = [entry for entry in entries if entry.partition('=')[0].strip() == command]
    if not taken:
        setup_file.write_text(_insert_entry_point(text, listed, entry_point), encoding='utf-8')
        entries = [entry_point, *entries]
    elif [_parse_entry_point(entry)[1:] for entry in taken] != [(module, name)]:
        raise NotAdded(
            f'setup.py has another line for {command}: {taken[0]!r}. Change it there yourself, or '
            'choose another name'
        )
    listed_in = workspace.ros_ws_path(setup_file)
    tell(
        f'kept     {entry_point!r} in {listed_in}:'
        if taken
        else f'added    {entry_point!r} in {listed_in}:'
    )
    print("'console_scripts': [", *(f'    {entry!r},' for entry in entries), ']', sep='\n')


def _parse_entry_point(entry_point: str) -> tuple[str, Path, str]:
    """Return a command, the module in the student's package, and the function in it."""
    found = _FORM.fullmatch(entry_point.strip())
    if found is None or found['package'] != workspace.NAME:
        raise NotAdded(
            f"expected an entry point such as 'greeter = {workspace.NAME}.greeter:main', saw "
            f'{entry_point!r}'
        )
    module = workspace.package_folder() / workspace.NAME / f'{found["module"]}.py'
    return found['command'], module, found['function']


def _expect_function(module: Path, name: str) -> None:
    if name not in [n.name for n in _parse(module).body if isinstance(n, ast.FunctionDef)]:
        raise NotAdded(
            f'{workspace.ros_ws_path(module)} has no function {name}: write it there, or run the '
            f'cell with %%write_node {module.name} again'
        )


def _parse(file: Path) -> ast.Module:
    try:
        return ast.parse(file.read_text(encoding='utf-8'))
    except SyntaxError as error:
        raise NotAdded(
            f'{workspace.ros_ws_path(file)} is not valid Python (line {error.lineno}: '
            f'{error.msg}): fix that line, then run this cell again'
        ) from None


def _find_console_scripts(tree: ast.Module) -> ast.List | None:
    """Return the list of `console_scripts` in a setup.py."""
    dicts = [node for node in ast.walk(tree) if isinstance(node, ast.Dict)]
    pairs = [pair for node in dicts for pair in zip(node.keys, node.values, strict=True)]
    for key, value in pairs:
        if getattr(key, 'value', None) == 'console_scripts' and isinstance(value, ast.List):
            return value
    return None


def _insert_entry_point(text: str, listed: ast.List, entry_point: str) -> str:
    """Return the text with the entry inserted as the first of the list."""
    lines = text.encode().splitlines(keepends=True)  # ast counts bytes
    line, column = lines[listed.lineno - 1], listed.col_offset + 1
    new = f"'{entry_point}',"
    if listed.elts and listed.elts[0].lineno > listed.lineno:
        new = f'\n{" " * listed.elts[0].col_offset}{new}'
    elif listed.elts:
        new += ' '
    lines[listed.lineno - 1] = line[:column] + new.encode() + line[column:]
    return b''.join(lines).decode()
