"""What belongs to a student's notebook: files beside it, and the packages that it needs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.collect.incoming import Incoming
from grader.collect.name_forms import strip_late_mark
from grader.collect.naming import Owner
from grader.collect.owners import foreign_file_reason
from grader.collect.package_folders import (
    ChosenFiles,
    IncomingPackage,
    choose_files,
    first_package_of,
    number_of,
)
from grader.common.dates import date_of
from grader.common.student_names import problem_of_id
from grader.notebook.submission import SECRET, TIMESTAMP


@dataclass(frozen=True)
class Companions:
    """What belongs to one notebook."""

    modules: Mapping[str, Incoming]
    """The student's Python files in the same folder, by name."""
    packages: Mapping[str, tuple[IncomingPackage, ChosenFiles]]
    """By the package's name: where it is, and which of its files are taken."""
    stamp: Incoming | None
    """nbgrader's timestamp.txt."""
    secret: Incoming | None
    """nbgrader's secret file, which determines the name of the feedback page in the exchange."""
    foreign: Mapping[Incoming, str]
    """Files beside it that another user put there, with the reason why they are not taken."""

    def extra_files(self) -> dict[str, Path]:
        """Return modules, by name, and files of packages, by path in the submission."""
        extra = {name: each.readable for name, each in self.modules.items()}
        for _, chosen in self.packages.values():
            extra |= chosen.taken
        return extra

    def change_times(self) -> list[datetime]:
        """Return the change times (ctime) of the files that students themselves put there."""
        of_modules = [each.changed for each in self.modules.values() if each.changed]
        return of_modules + [at for _, chosen in self.packages.values() for at in chosen.changed]

    def timestamp(self) -> datetime | None:
        """Return the time in timestamp.txt, unless a student wrote that file."""
        return date_of(self.stamp.readable) if self.stamp and not self.stamp.login else None

    def left_out(self) -> tuple[str, ...]:
        """Return what the student is told about files that were not taken."""
        chosen = {name: files for name, (_, files) in self.packages.items()}
        return tuple(clause for name, files in chosen.items() for clause in files.clauses(name))

    def used_files(self) -> set[Incoming]:
        """Return the files beside the notebook that are used with it."""
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
    """Return what belongs to a notebook, from the files `beside` it and from `packages`, by key.

    `asked_for` are the names of the packages that are handed in with it.
    """
    has_folder = bool(owner.by_folder or notebook.archive)
    reasons = {each: foreign_file_reason(each, owner.student_id) for each in beside.values()}
    foreign = {each: why for each, why in reasons.items() if why} if has_folder else {}
    files = {name: each for name, each in beside.items() if has_folder and each not in foreign}
    is_believed = not (notebook.archive or owner.label)
    number = '' if has_folder else number_of(notebook)
    found = {
        name: first_package_of(
            owner.student_id, packages.get((name, notebook.parts[:-1], number), ())
        )
        for name in asked_for
        if number or has_folder
    }
    return Companions(
        modules={
            strip_late_mark(name): each
            for name, each in files.items()
            if name.endswith('.py') and not problem_of_id(name)
        },
        packages={
            n: (there, choose_files(there, owner.student_id))
            for n, there in found.items()
            if there
        },
        stamp=files.get(TIMESTAMP) if is_believed else None,
        secret=files.get(SECRET) if is_believed else None,
        foreign=foreign,
    )
