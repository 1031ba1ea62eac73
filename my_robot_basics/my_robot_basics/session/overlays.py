"""Interface packages that were built in a workspace: whether they can be used, and why not.

sourced.py also loads this module by its path, while Python looks for a package of interfaces, and
an older copy of the course's package may be first in PYTHONPATH: so this module imports only the
standard library. Whatever is broken in a workspace becomes a sentence: an error in here would be
the traceback of the student's `import`.
"""

import json
import os
import shlex
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

INDEX = 'share/ament_index/resource_index/rosidl_interfaces'
"""The part of the ament index with a file for each package of interfaces, which lists its .msg,
.srv and .action files."""
LAYOUT = '.colcon_install_layout'
"""The file that marks an install folder of colcon; a robot's /opt/ros has none."""
LIBRARIES = (
    *('rosidl_generator_c', 'rosidl_generator_py', 'rosidl_typesupport_c'),
    *('rosidl_typesupport_fastrtps_c', 'rosidl_typesupport_introspection_c'),
)
"""The libraries of a built package that a Python node loads: lib<package>__<name>.so."""
ELF = b'\x7fELF'
"""The first bytes of a library; an interrupted build may leave an empty file."""


@dataclass(frozen=True)
class Overlay:
    """A package of interfaces in the folder in which colcon has installed it."""

    prefix: Path
    """install/PACKAGE of a workspace, or its install/ after `colcon build --merge-install`."""
    package: str

    @property
    def is_merged(self) -> bool:
        """Whether all packages of the workspace share the folder."""
        return os.path.isfile(self.prefix / LAYOUT)

    @property
    def workspace(self) -> Path:
        """The folder that holds src/, build/ and install/."""
        return self.prefix.parent if self.is_merged else self.prefix.parent.parent

    @property
    def python_folder(self) -> Path:
        """The folder, relative to the prefix, of its modules for the running Python version."""
        version = '{}.{}'.format(*sys.version_info)
        return Path('lib', f'python{version}', 'site-packages', self.package)

    def fault(self) -> str:
        """Say why the package cannot be loaded, and what to do; '' if it is complete."""
        try:
            return self._fault()
        except (OSError, UnicodeDecodeError) as error:
            return self.unreadable(error)

    def unreadable(self, error: Exception) -> str:
        """Say that a file or folder of the package cannot be read, and what to do."""
        return self._message(
            f'cannot be read ({error}), so it is damaged or belongs to another user'
        )

    def _fault(self) -> str:
        if not (self.prefix / self.python_folder).is_dir():
            for other in sorted(self.prefix.glob(f'lib/python3.*/site-packages/{self.package}')):
                built = other.parts[-3].removeprefix('python')
                this = '{}.{}'.format(*sys.version_info)
                return self._message(f'was built for Python {built}, and this is Python {this}')
        for file in self._needed():
            if not (self.prefix / file).exists():
                return self._message(f'is only half built, without {file}')
            if file.suffix == '.so' and not _is_library(self.prefix / file):
                return self._message(f'is only half built: {file} is empty or cut short')
        return ''

    def difference(self) -> str:
        """Say how it differs from its sources or from the course's package; '' if it does not.

        Its nodes run, but they cannot communicate with nodes that use the other definition.
        """
        try:
            return self._difference()
        except (OSError, UnicodeDecodeError) as error:
            return self._message(f'cannot be compared with its sources ({error})')

    def _difference(self) -> str:
        shared = self.prefix / 'share' / self.package
        for file in self._definitions():
            source = self.workspace / 'src' / self.package / file
            if source.is_file() and source.read_bytes() != (shared / file).read_bytes():
                return self._message(f'was built before {file} in src was changed')
        for file in self._definitions():
            name = Path('share', self.package, file).with_suffix('.json')
            ours, theirs = (_type_hashes(Path(root, name)) for root in (sys.prefix, self.prefix))
            if theirs is None:
                return self._message(f'has a broken {name}')
            if ours and ours != theirs:
                return (
                    f'{self.package} in {self.prefix} has another {file} than the course, so '
                    "nodes that use it cannot communicate with nodes that use the course's: keep "
                    'it if that is what you want, or take the file of the course '
                    f'(./course workspace --refresh {self.package}) and build again'
                )
        return ''

    def _needed(self) -> Iterator[Path]:
        """Yield the files that must exist, relative to the prefix."""
        yield Path(INDEX, self.package)
        for file in self._definitions():
            yield Path('share', self.package, file)
            yield self.python_folder / file.parent / '__init__.py'
        yield from (Path('lib', f'lib{self.package}__{name}.so') for name in LIBRARIES)
        yield self.python_folder / f'{self.package}_s__rosidl_typesupport_c.so'

    def _definitions(self) -> list[Path]:
        """Its .msg, .srv and .action files, as ROS's index lists them."""
        index = self.prefix / INDEX / self.package
        listed = index.read_text(encoding='utf-8').split() if index.is_file() else []
        return [Path(file) for file in listed if not file.endswith('.idl')]

    def _message(self, fault: str) -> str:
        folders, option = f'build/{self.package} install/{self.package}', ''
        if self.is_merged:
            folders, option = 'build install', '--merge-install '
        command = (
            f'cd {_quoted(self.workspace)} && rm -rf {folders} && colcon build {option}'
            f'--packages-select {self.package} && source install/setup.bash'
        )
        return f'{self.package} in {self.prefix} {fault}: build it again, with `{command}`'


def gone(prefix: Path) -> str:
    """Return the sentence about a sourced folder that no longer exists or cannot be read."""
    try:
        os.listdir(prefix)
    except PermissionError as error:
        return (
            f'{prefix} cannot be read ({error}), and this terminal looks for its package there: '
            'get the right to read it (`ls -ld` shows whose it is), or open a new terminal, which '
            "uses the course's package if there is one"
        )
    except OSError:
        pass  # it is gone, as is said below
    return (
        f'{prefix} is gone, and this terminal still looks for its package there: build the '
        "package again, or open a new terminal, which uses the course's package if there is one"
    )


def say(sentence: str) -> None:
    """Print a sentence to stderr, once in a process, in the terminal's language.

    It stays English if PYTHONPATH has an older copy of this package, without `language`.
    """
    if sentence not in _said:
        _said.add(sentence)
        print(f'course: {_translated(sentence)}', file=sys.stderr)


def _translated(sentence: str) -> str:
    try:
        from my_robot_basics.language.speaking import in_language_here
    except ImportError:
        return sentence
    return in_language_here(sentence)


def was_said(sentence: str) -> bool:
    """Whether this process has printed the sentence already."""
    return sentence in _said


_said: set[str] = set()


def _is_library(file: Path) -> bool:
    with file.open('rb') as content:
        return content.read(len(ELF)) == ELF


def _type_hashes(file: Path) -> dict[str, str] | None:
    """Return the hash of each type in a .json file of rosidl; {} without file, None if broken."""
    if not file.is_file():
        return {}
    try:
        listed = json.loads(file.read_text(encoding='utf-8'))['type_hashes']
        return {each['type_name']: each['hash_string'] for each in listed}
    except (ValueError, KeyError, TypeError):
        return None


def _quoted(workspace: Path) -> str:
    """Return a workspace's path, quoted for a shell: "$ROS_WS" if that is the same."""
    known = os.environ.get('ROS_WS')
    return '"$ROS_WS"' if known and Path(known) == workspace else shlex.quote(str(workspace))
