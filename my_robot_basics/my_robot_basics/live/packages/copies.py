"""A package of the course, and the student's own copy of it in the workspace."""

import filecmp
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.language.speaking import in_language_here

LEFTOVERS = ('.', '__pycache__', 'build', 'install', 'log')
"""Beginnings of the names of folders that programs leave behind."""
TO_SHOW: tuple[str, ...] = ('new', 'changed', 'missing')
NEW, CHANGED, MISSING = TO_SHOW
"""How a file of the copy can differ from the package's."""


@dataclass(frozen=True)
class Copied:
    """A package of the course, and the student's copy of it."""

    source: Path
    """The package in the course."""
    target: Path
    """The student's copy."""
    patterns: tuple[str, ...]
    """Glob patterns of the files that a build needs."""

    def make(self) -> None:
        """Copy the package; the target appears only when it is complete."""
        unfinished = self.target.with_name(f'.{self.target.name}.part')
        shutil.rmtree(unfinished, ignore_errors=True)
        for path in self._files():
            target = unfinished / path.relative_to(self.source)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
        unfinished.rename(self.target)

    def move_aside(self, shelf: Path) -> Path:
        """Move the student's folder to `shelf` under a new number; return its new path."""
        number = 1 + sum(1 for _ in shelf.glob(f'{self.target.name}_*'))
        return self.target.rename(shelf / f'{self.target.name}_{number}')

    def differences(self) -> list[str]:
        """Return a line for each file of the copy that differs from the package."""
        if not self.target.exists():
            return []
        ours = {path.relative_to(self.source) for path in self._files()}
        there = (
            path.relative_to(self.target) for path in self.target.rglob('*') if path.is_file()
        )
        theirs = {
            name
            for name in there
            if not any(part.startswith(LEFTOVERS) for part in name.parts[:-1])
        }
        words = dict.fromkeys(theirs - ours, NEW) | dict.fromkeys(ours - theirs, MISSING)
        for name in ours & theirs:
            if not filecmp.cmp(self.target / name, self.source / name, shallow=False):
                words[name] = CHANGED
        return [f'{in_language_here(words[name]):8} {name}' for name in sorted(words)]

    def _files(self) -> Iterator[Path]:
        for pattern in self.patterns:
            yield from (path for path in sorted(self.source.glob(pattern)) if path.is_file())
