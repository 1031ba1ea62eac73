"""What goes with a student's notebook: files that lie beside it, and the packages it asks for."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.collect.incoming import Incoming
from grader.collect.naming import Owner
from grader.collect.owners import why_not_theirs
from grader.collect.package_folders import (
    ChosenFiles,
    IncomingPackage,
    choose,
    first_of,
    number_of,
)
from grader.common.dates import date_of
from grader.common.student_names import problem_of_id
from grader.notebook.submission import SECRET, TIMESTAMP


@dataclass(frozen=True)
class Companions:
    """What goes with one notebook."""

    modules: Mapping[str, Incoming]
    """The student's Python files beside it, by name."""
    packages: Mapping[str, tuple[IncomingPackage, ChosenFiles]]
    """By the package's name: where it lies, and what is taken of it."""
    stamp: Incoming | None
    """nbgrader's file with the time."""
    secret: Incoming | None
    """nbgrader's, which names the page of feedback in the exchange."""
    foreign: Mapping[Incoming, str]
    """Why files beside it are another user's."""

    def extra(self) -> dict[str, Path]:
        """Return the modules, by name, and the files of packages, by path."""
        extra = {name: each.readable for name, each in self.modules.items()}
        for _, chosen in self.packages.values():
            extra |= chosen.taken
        return extra

    def changed(self) -> list[datetime]:
        """Return when Linux last saw each of them change, of those that a student wrote."""
        of_modules = [each.changed for each in self.modules.values() if each.changed]
        return of_modules + [at for _, chosen in self.packages.values() for at in chosen.changed]

    def stamped(self) -> datetime | None:
        """Return the time in nbgrader's file, unless a student wrote it."""
        return date_of(self.stamp.readable) if self.stamp and not self.stamp.login else None

    def left_out(self) -> tuple[str, ...]:
        """Return what the student is told of files that were not taken."""
        chosen = {name: files for name, (_, files) in self.packages.items()}
        return tuple(clause for name, files in chosen.items() for clause in files.clauses(name))

    def used(self) -> set[Incoming]:
        """Return the files beside the notebook that are used for it."""
        is_date = self.stamp is not None and date_of(self.stamp.readable) is not None
        others = self.stamp if is_date else None, self.secret
        return {*self.modules.values(), *(each for each in others if each)}


def find_companions(
    notebook: Incoming,
    owner: Owner,
    *,
    beside: Mapping[str, Incoming],
    asked_for: Iterable[str],
    packages: Mapping[tuple, Sequence[IncomingPackage]],
) -> Companions:
    """Return what goes with a notebook, of what lies `beside` it and of `packages` by their key.

    `asked_for`: the names of the packages that are handed in with it.
    """
    has_folder = bool(owner.by_folder or notebook.archive)
    reasons = {each: why_not_theirs(each, owner.student_id) for each in beside.values()}
    foreign = {each: why for each, why in reasons.items() if why} if has_folder else {}
    files = {name: each for name, each in beside.items() if has_folder and each not in foreign}
    is_believed = not (notebook.archive or owner.label)
    number = '' if has_folder else number_of(notebook)
    found = {
        name: first_of(owner.student_id, packages.get((name, notebook.parts[:-1], number), ()))
        for name in asked_for
        if number or has_folder
    }
    return Companions(
        modules={n: e for n, e in files.items() if n.endswith('.py') and not problem_of_id(n)},
        packages={
            n: (there, choose(there, owner.student_id)) for n, there in found.items() if there
        },
        stamp=files.get(TIMESTAMP) if is_believed else None,
        secret=files.get(SECRET) if is_believed else None,
        foreign=foreign,
    )
