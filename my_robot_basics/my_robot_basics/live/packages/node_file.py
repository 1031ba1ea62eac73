"""`%%write_node FILE`: write the text of a cell as a module of the student's package."""

import shutil
from pathlib import Path

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.packages import program, workspace
from my_robot_basics.session import kernel
from my_robot_basics.session.errors import LiveError, tell

ROOM_FOR_NAMES = 34
"""Columns for the names in the tree, before their descriptions."""


class NotWritten(LiveError):
    """`%%write_node` did not get the name of a module, or there is no workspace."""


def register() -> None:
    """Register the magic command in the notebook."""
    kernel.shell().register_magic_function(write_node, 'cell', 'write_node')


def write_node(line: str, cell: str) -> None:
    """Write the cell into the workspace's package; keep a copy of a file that differs.

    A class whose body is `...` is replaced by the text of the notebook's class of that name, and
    the whole file is printed. If that class is not written yet, this is printed, and an existing
    file is not changed. Raises NotWritten or NotAProgram.
    """
    name = line.strip()
    if not (name.endswith('.py') and name.removesuffix('.py').isidentifier()):
        raise NotWritten(f'expected a name such as greeter.py after %%write_node, saw {name!r}')
    modules = workspace.package_folder() / workspace.NAME
    if not modules.is_dir():
        raise NotWritten('there is no workspace yet: run the cell with make_workspace() first')
    target = modules / name
    try:
        text = program.fill_in(cell)
    except program.NotAnswered as error:  # printed, so that *Run All* continues
        if target.exists():
            tell(f'not written: {error} ({name} stays as it was)', in_one=False)
        else:
            tell(f'not written: {error}', in_one=False)
        return
    if target.exists() and target.read_text(encoding='utf-8') != text:
        tell(f'moved    {workspace.ros_ws_path(_copy_to_shelf(target))}: the file as it was')
    target.write_text(text, encoding='utf-8')
    tell(f'written  {workspace.ros_ws_path(target)}')
    if text != cell:
        print(f'\n{text}', end='')


def _copy_to_shelf(target: Path) -> Path:
    shelf = workspace.make_shelf()
    number = 1 + sum(1 for _ in shelf.glob(f'{target.stem}_*.py'))
    return Path(shutil.copy(target, shelf / f'{target.stem}_{number}.py'))


def show_workspace() -> None:
    """Print the workspace as a tree: its folders, and the files that are yours."""
    lines = [f'{workspace.ros_ws_path(workspace.package_folder().parents[1])}/']
    lines += _below(workspace.package_folder().parents[1], Path(), '')
    print('\n'.join(lines))


def _below(root: Path, folder: Path, indent: str) -> list[str]:
    """Return a line for each existing entry of a folder that is listed in _WORDS."""
    lines = []
    entries = _entries(root, folder)
    for entry in entries:
        is_last = entry is entries[-1]
        path = folder / entry
        slash = '/' if (root / path).is_dir() else ''
        name = f'{indent}{"└── " if is_last else "├── "}{entry}{slash}'
        words = in_language_here(_WORDS.get(str(path), 'your own node'))
        lines.append(f'{name:{ROOM_FOR_NAMES}}{words}')
        lines += _below(root, path, indent + ('    ' if is_last else '│   '))
    return lines


def _entries(root: Path, folder: Path) -> list[str]:
    here = [Path(path) for path in _WORDS]
    names = [path.name for path in here if path.parent == folder and (root / path).exists()]
    if folder == _MODULES:
        theirs = {path.name for path in (root / folder).glob('*.py')}
        names += sorted(
            theirs - {path.name for path in (workspace.PACKAGE / workspace.NAME).glob('*.py')}
        )
    return names


TO_SHOW: tuple[str, ...] = ('a package',)
_PACKAGE = Path('src', workspace.NAME)
_MODULES = _PACKAGE / workspace.NAME
_WORDS = {
    'src': 'sources: what you write',
    str(_PACKAGE): TO_SHOW[0],
    str(_PACKAGE / 'package.xml'): 'its name, and what it needs',
    str(_PACKAGE / 'setup.py'): 'its entry points',
    str(_MODULES): 'its Python modules',
    'build': 'where colcon works',
    'install': 'what ros2 run finds after source install/setup.bash',
    'log': 'what each build printed',
}
