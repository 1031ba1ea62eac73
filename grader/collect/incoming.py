"""A file that came in: its path, where it can be read, and what is wrong with it."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

LITTER = {'__MACOSX', '__pycache__', 'Thumbs.db', 'desktop.ini'}


@dataclass(frozen=True)
class Incoming:
    """A file that came in, wherever it lay."""

    parts: tuple[str, ...]
    """Its path within what was collected; archives are folders here."""
    file: Path | None = None
    """Where it can be read; None where it is not wanted, or has a problem."""
    modified: datetime | None = None
    """When it, or the archive it came in, was written."""
    problem: str = ''
    """Why it can't be read."""
    archive: int = 0
    """How many of its parts lead to a student's archive and name it; 0 where there is none."""
    login: str = ''
    """The user of this machine whose it is, where neither we nor a platform put it there."""
    changed: datetime | None = None
    """When Linux last saw such a user change it, or a folder of theirs around it."""

    @property
    def path(self) -> str:
        """Return its path as one text."""
        return '/'.join(self.parts)

    @property
    def readable(self) -> Path:
        """Where it can be read; only of what is wanted and has no problem."""
        assert self.file is not None
        return self.file

    @property
    def litter(self) -> bool:
        """Whether an editor or a desktop left it there, not a person."""
        hidden = any(part.startswith('.') or part in LITTER for part in self.parts)
        return hidden and not self.problem


def as_json(each: Incoming) -> dict:
    """Return a file that came in as JSON."""
    return vars(each) | {
        'file': each.file and str(each.file),
        'modified': each.modified and each.modified.isoformat(),
        'changed': each.changed and each.changed.isoformat(),
    }


def from_json(said: dict) -> Incoming:
    """Return what `as_json` was given."""
    return Incoming(
        parts=tuple(said['parts']),
        file=said['file'] and Path(said['file']),
        modified=said['modified'] and datetime.fromisoformat(said['modified']),
        problem=said['problem'],
        archive=said['archive'],
        login=said['login'],
        changed=said['changed'] and datetime.fromisoformat(said['changed']),
    )


def is_notebook(each: Incoming) -> bool:
    """Whether a file is a notebook that can be read."""
    return not each.problem and each.parts[-1].lower().endswith('.ipynb')
