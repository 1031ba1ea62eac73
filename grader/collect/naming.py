"""Find student, assignment and time of a notebook from the names of its file and folders.

The outermost folder, archive or file that a person or a course platform named decides. Names
inside it were chosen by the student: they may agree, but never make it another student's.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

from grader.collect.archive_entries import ARCHIVE
from grader.collect.incoming import Incoming, is_notebook
from grader.collect.name_forms import NameForms, shared_folders, stem_of, strip_archive_ending
from grader.collect.platforms import PlatformLabel, label_in, student_in
from grader.common.dates import date_in
from grader.common.student_names import UnclearOwner, is_nobody, same_person

_AGAIN = re.compile(r'-\d+(?=$|\.(zip|tar|tgz|tbz2|txz)\b)', re.IGNORECASE)
"""What a platform appends to a name when a student hands in again."""
EXPECTED = (
    'expected STUDENT_ASSIGNMENT.ipynb, STUDENT/ASSIGNMENT/ASSIGNMENT.ipynb or an archive named '
    'after the student'
)
_SEVERAL = "collect the folder by itself in which the students' folders lie, or rename it"


@dataclass(frozen=True)
class Owner:
    """The owner of a notebook, as far as names say."""

    student_id: str
    assignment: str
    by_folder: bool
    """Whether everything in its folder belongs to this student."""
    handed_in: datetime | None = None
    """In UTC; None if its name contains no time."""
    label: PlatformLabel | None = None
    """What a course platform wrote about the student into a name."""
    above: tuple[str, ...] = ()
    """The folders around the folder, archive or file that decided."""
    inside: tuple[str, ...] = ()
    """The folders and archives inside that one, down to the notebook."""
    aliases: tuple[str, ...] = ()
    """Other names of the same student, which names inside may be spellings of."""


class Naming:
    """Interprets the names of all collected files and folders."""

    def __init__(
        self,
        found: Sequence[Incoming],
        assignments: Iterable[str],
        students: Iterable[str] = (),
    ) -> None:
        """Look at all collected files; `students` are those who are known already."""
        self._known = frozenset(assignments)
        self.forms = NameForms(self._known)
        notebooks = [each for each in found if is_notebook(each)]
        self._by_platform = self._all_by_platform(notebooks, list(students))
        self._shared = len(shared_folders([each.parts[:-1] for each in notebooks]))
        named = (self.forms.parse_assignment_name(stem_of(each.parts[-1])) for each in notebooks)
        self._several = len({name.student for name in named if name}) > 1

    def owner(self, each: Incoming) -> Owner:
        """Return the owner of a notebook. Raises UnclearOwner."""
        at = self._deciding_index(each)
        if at is None:
            return self._owner_by_file_name(each)
        name, above, inside = each.parts[at], each.parts[:at], each.parts[at + 1 : -1]
        label = label_in(name)
        stem = stem_of(each.parts[-1])
        if at == len(each.parts) - 1:  # the file itself decides; the label precedes its name
            assert label is not None
            stem = stem_of(label.rest)
        elif label and label.rest:  # the student's own name for that folder or archive
            inside = (_AGAIN.sub('', label.rest), *inside)
        if label and label.platform.numbers_copies:
            stem = _AGAIN.sub('', stem)
        if parsed := self.forms.parse_exchange_name(name):
            if stem != parsed.assignment or inside:
                raise UnclearOwner(f'in the exchange, {parsed.assignment}.ipynb was expected here')
            when = date_in(re.sub(r'(\d\d)_(\d\d)_(\d\d)', r'\1:\2:\3', parsed.time))
            return Owner(student_in(parsed.student), stem, True, when, above=above)
        assignment = self._assignment(stem, each.parts[:-1])
        student = student_in(self.forms.student_of(name))
        if label and label.platform.may_be_class and not ARCHIVE.search(name):
            # without a name of the student's, it holds what was handed in, also archives
            end = each.archive - 1 if each.archive and not label.rest else -1
            self._expect_no_class(student, label, each.parts[at + 1 : end])
        named = self.forms.parse_assignment_name(stem)
        if named and not self.may_name(named.student, student):
            where = f'in the archive of {student}' if each.archive else f'in a folder {student}'
            where = f'in what {student} handed in' if label else where
            raise UnclearOwner(
                f"it is named after {named.student}, and {where}: rename it if it is {student}'s, "
                'or else collect it by itself'
            )
        return Owner(
            student,
            assignment,
            by_folder=at < len(each.parts) - 1,
            handed_in=label.handed_in if label else None,
            label=label,
            above=above,
            inside=inside,
        )

    def may_name(self, who: str, *students: str) -> bool:
        """Whether a folder's name may belong to these students: it does not name another one."""
        ours = (same_person(who, student) for student in students)
        return who in self._known or is_nobody(who) or any(ours)

    def _expect_no_class(self, student: str, label: PlatformLabel, folders: Sequence[str]) -> None:
        """Raise UnclearOwner if a folder named like an upload may contain a class."""
        for who in map(self.forms.student_of, folders):
            if not self.may_name(who, student, label.rest):
                raise UnclearOwner(f'it may be of {student} or of {who}: {_SEVERAL}')

    def _deciding_index(self, each: Incoming) -> int | None:
        """Return the index of the path component that decides; None if only the file's name does.

        Raises UnclearOwner if several may.
        """
        if self._by_platform:
            return self._first_by_platform(each)
        folders = each.parts[: each.archive] or each.parts[:-1]
        candidates = self._candidates(folders, self._shared)
        if not candidates and not (self._several and not each.archive):
            candidates = self._candidates(folders, 0)  # all files may be of the same student
        if not candidates:
            if each.archive:
                raise UnclearOwner(f'nothing says whose it is: {EXPECTED}')
            return len(folders) if label_in(each.parts[-1]) else None
        first, *others = candidates
        if label_in(folders[first]) or self.forms.parse_exchange_name(folders[first]):
            return first
        names = [self.forms.student_of(folders[at]) for at in (first, *others)]
        if not all(same_person(name, names[0]) for name in names):
            raise UnclearOwner(f'it may be of {" or of ".join(names)}: {_SEVERAL}')
        return first

    def _candidates(self, folders: Sequence[str], start: int) -> list[int]:
        """Return the indexes of folders, from `start` on, that may be named after a student."""
        names = [(at, strip_archive_ending(f)) for at, f in enumerate(folders) if at >= start]
        return [at for at, name in names if name not in self._known and not is_nobody(name)]

    def _owner_by_file_name(self, each: Incoming) -> Owner:
        stem = stem_of(each.parts[-1])
        assignment = self._assignment(stem, each.parts[:-1])
        if stem in self._known:
            raise UnclearOwner(f'nothing says whose it is: {EXPECTED}')
        named = self.forms.parse_assignment_name(stem)
        assert named is not None  # or _assignment would have raised
        student = student_in(named.student)
        return Owner(student, assignment, by_folder=False, above=each.parts[:-1])

    def _assignment(self, stem: str, folders: Sequence[str]) -> str:
        """Return the assignment that a file is named after. Raises UnclearOwner."""
        named = self.forms.parse_assignment_name(stem)
        if stem not in self._known and not named:
            near = [name for name in self._known if name.casefold() in stem.casefold()]
            known = ', '.join(sorted(near or self._known))
            way_out = 'rename it, in an unpacked copy of an archive, and collect that'
            raise UnclearOwner(f'named after no assignment: {EXPECTED}, with {known}; {way_out}')
        assignment = named.assignment if named else stem
        for folder in reversed(folders):
            name = strip_archive_ending(folder)
            of = self.forms.parse_assignment_name(name)
            other = name if name in self._known else of.assignment if of else assignment
            if other != assignment:
                raise UnclearOwner(f'it is in a folder of another assignment, {other}')
        return assignment

    def _all_by_platform(self, notebooks: Sequence[Incoming], students: Sequence[str]) -> bool:
        """Whether a platform or the exchange named all notebooks, in folders of the instructor.

        A student's own folder could contain an imitation of such names. Then it would be beside
        other such folders, or have the name of a known student.
        """
        decides = [self._first_by_platform(each) for each in notebooks]
        if None in decides:
            return False
        above = {each.parts[:at] for each, at in zip(notebooks, decides, strict=True)}
        names = {name for folders in above for name in folders if not is_nobody(name)}
        return not (
            any(folders[:n] in above for folders in above for n in range(len(folders)))
            or any(same_person(name, student) for name in names for student in students)
        )

    def _first_by_platform(self, each: Incoming) -> int | None:
        """Return the index of the outermost component that a platform or the exchange named."""
        for at, part in enumerate(each.parts[: each.archive] or each.parts):
            is_folder = at < len(each.parts) - 1
            if label_in(part) or (is_folder and self.forms.parse_exchange_name(part)):
                return at
        return None
