"""Names of other students inside what a student handed in."""

from collections.abc import Iterator, Mapping

from grader.collect.incoming import Incoming
from grader.collect.name_forms import strip_archive_ending
from grader.collect.naming import Naming, Owner
from grader.common.student_names import same_person, spellings


class Claims:
    """Compares the names of folders in an upload with its owner's."""

    def __init__(
        self,
        owners: Mapping[Incoming, Owner],
        naming: Naming,
        known: Mapping[str, set[str]],
    ) -> None:
        """Look at all notebooks; `known` has all students, by the spellings of their names."""
        self._naming = naming
        self._known = known
        self._hold_own = {
            folder for each, owner in owners.items() for folder in self._folders_of(each, owner)
        }

    def check(self, each: Incoming, owner: Owner) -> tuple[str, str]:
        """Return a remark on the names around a notebook, and the reason why it is not taken."""
        whose, remark = owner.student_id, ''
        for who, surely, folder in self._others(each, owner):
            known = set().union(*(self._known.get(name, ()) for name in spellings(who)))
            if surely or known - {whose}:
                return '', (
                    f'it lies in what {whose} handed in, under the name of {who}: if it is '
                    f"{whose}'s, rename that; if others packed it, collect what they packed by "
                    'itself'
                )
            if folder in self._hold_own:
                return '', (
                    f'what {whose} handed in has a folder {whose}, and {who} beside it: if {who} '
                    'is another student, put both into an empty folder (unpack the archive '
                    f"there), and collect that; if it is {whose}'s, rename it to {whose}"
                )
            remark = remark or f'from a folder of their own, {who!r}'
        return remark, ''

    def _others(self, each: Incoming, owner: Owner) -> Iterator[tuple[str, bool, tuple[str, ...]]]:
        """Yield other students named in an upload, if the name has a student's form, and where."""
        for at, name in enumerate(owner.inside, len(each.parts) - 1 - len(owner.inside)):
            who = self._naming.forms.student_of(name)
            if not self._naming.may_name(who, owner.student_id, *owner.aliases):
                yield who, who != strip_archive_ending(name), each.parts[:at]

    def _folders_of(self, each: Incoming, owner: Owner) -> Iterator[tuple[str, ...]]:
        """Yield the folders in an upload that hold one which is named after its owner.

        What lies beside that one under another name may be another student's.
        """
        for at in range(len(owner.above) + 1, len(each.parts) - 1):
            who = self._naming.forms.student_of(each.parts[at])
            if any(same_person(who, name) for name in (owner.student_id, *owner.aliases)):
                yield each.parts[:at]
