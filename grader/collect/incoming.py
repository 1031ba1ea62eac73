"""A collected file: its path, where it can be read, and what is wrong with it."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

LITTER = {'__MACOSX', '__pycache__', 'Thumbs.db', 'desktop.ini'}


@dataclass(frozen=True)
class Incoming:
    """A collected file, from a folder or an archive."""

    parts: tuple[str, ...]
    """Its path within what was collected; an archive counts as a folder."""
    file: Path | None = None
    """Where it can be read; None if it is not wanted, or has a problem."""
    modified: datetime | None = None
    """When it, or the archive that contained it, was last modified."""
    problem: str = ''
    """Why it can't be read, or ''."""
    archive: int = 0
    """How many of its parts are the path of the student's archive; 0 if it was in none."""
    login: str = ''
    """The user of this machine who put it there; '' for the grader's user or a platform's."""
    changed: datetime | None = None
    """The last change (ctime) of it, or of that user's folder around it; None without a login."""

    @property
    def path(self) -> str:
        """Return its path as one string."""
        return '/'.join(self.parts)

    @property
    def readable(self) -> Path:
        """Return where it can be read; only for a wanted file without a problem."""
        assert self.file is not None
        return self.file

    @property
    def is_litter(self) -> bool:
        """Whether a program left it there, such as an editor or a desktop."""
        hidden = any(part.startswith('.') or part in LITTER for part in self.parts)
        return hidden and not self.problem


def as_json(each: Incoming) -> dict:
    """Return a collected file in a form that JSON can hold."""
    return vars(each) | {
        'file': each.file and str(each.file),
        'modified': each.modified and each.modified.isoformat(),
        'changed': each.changed and each.changed.isoformat(),
    }


def from_json(said: dict) -> Incoming:
    """Return the file that `as_json` was given."""
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
    """Whether it is a notebook without a problem."""
    return not each.problem and each.parts[-1].lower().endswith('.ipynb')
