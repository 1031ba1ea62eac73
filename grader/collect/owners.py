"""The owner of each notebook; a notebook is refused if names disagree or students share a name."""

import unicodedata
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

from grader.collect.claims import Claims
from grader.collect.incoming import Incoming, is_notebook
from grader.collect.name_forms import strip_late_mark
from grader.collect.naming import Naming, Owner
from grader.common.student_names import UnclearOwner, spellings


def find_owners(
    found: Sequence[Incoming], assignments: Iterable[str], students: Iterable[str]
) -> tuple[dict[Incoming, Owner], dict[Incoming, str], dict[Incoming, str]]:
    """Return each notebook's owner, remarks on strange names, and why others have no owner."""
    owners: dict[Incoming, Owner] = {}
    problems: dict[Incoming, str] = {}
    students = set(students)
    naming = Naming(found, assignments, students)
    for each in filter(is_notebook, found):
        try:
            owner = _require_same_user(each, naming.owner(each))
            owners[each] = _keep_earlier_name(each, owner, students)
        except UnclearOwner as unclear:
            problems[each] = str(unclear)
    numbers = defaultdict(set)
    for owner in owners.values():
        numbers[_namesake_key(owner)].add(owner.label and owner.label.number)
    known = defaultdict(set)
    for student in {*students, *(owner.student_id for owner in owners.values())}:
        for spelling in spellings(student):
            known[spelling].add(student)
    claims = Claims(owners, naming, known)
    remarks = {}
    for each, owner in owners.items():
        remarks[each], problem = claims.check(each, owner)
        if len(numbers[_namesake_key(owner)]) > 1:
            problem = _several_students_problem(owner)
        if problem:
            problems[each] = problem
        remark = remarks[each] or _other_spelling(owner.student_id, known)
        remarks[each] = '; '.join(filter(None, (_earlier_name_remark(owner, students), remark)))
    return {e: owner for e, owner in owners.items() if e not in problems}, remarks, problems


def foreign_file_reason(each: Incoming, student: str) -> str:
    """Return why a file beside a student's notebook is not taken with it; '' if it is taken.

    Other users may have write access to the instructor's folder.
    """
    if each.login in ('', student):
        return ''
    return f'it is beside the notebook of {student}, and the user {each.login} put it there'


def late_remark(each: Incoming, owner: Owner) -> str:
    """Return a remark if a platform has marked it as late, in a name that it wrote itself."""
    if (label := owner.label) is None:
        return ''
    below = ''.join(each.parts[len(owner.above) + 1 :][:1])
    is_marked = label.platform.marks_late_files and strip_late_mark(below) != below
    if label.is_late or is_marked:
        return (
            f'{label.platform.title} has marked it as late, but no time is known, so '
            "it counts as in time: if the files' times are right, collect it with --file-times"
        )
    return ''


def _require_same_user(each: Incoming, owner: Owner) -> Owner:
    """Return the owner. Raises UnclearOwner if the file belongs to a user of another name."""
    if each.login in ('', owner.student_id):
        return owner
    raise UnclearOwner(
        f'it is named after {owner.student_id}, and the user {each.login} put it there: ask them. '
        'If you know better, copy it (cp -r) and collect the copy'
    )


def _keep_earlier_name(each: Incoming, owner: Owner, students: Collection[str]) -> Owner:
    """Return the owner; a student who is known by the whole name of a folder keeps that name.

    Before the form of ILIAS was known, the whole name of its folders was the student's.
    """
    whole = unicodedata.normalize('NFC', each.parts[len(owner.above)]).strip(' ')
    label = owner.label
    if not label or label.platform.number_of != 'student' or label.rest or whole not in students:
        return owner
    return replace(owner, student_id=whole, aliases=(owner.student_id,))


def _earlier_name_remark(owner: Owner, students: Collection[str]) -> str:
    """Return a remark if a student keeps an earlier name; another one may be in the gradebook."""
    for name in owner.aliases:
        if name in students:
            return (
                f'known by this name and as {name}, and taken under this one: if that is the same '
                'person, compare what both have, and remove the other one as '
                'docs/for-instructors.md says (If a student leaves)'
            )
        return f'known by this name from before, and keeps it; a new student would be {name}'
    return ''


def _namesake_key(owner: Owner) -> tuple:
    """Return a key; two owners with the same key and different numbers are two persons.

    Moodle numbers each student of one download; Canvas's number is the same in each download.
    """
    if owner.label is None:
        return (owner.student_id, owner.above, owner.assignment, None)
    platform = owner.label.platform
    if platform.number_of == 'student':
        return (owner.student_id, (), platform)
    if platform.number_of == 'assignment':
        return (owner.student_id, owner.above, platform)
    return (owner.student_id, owner.above, owner.assignment, platform)


def _several_students_problem(owner: Owner) -> str:
    assert owner.label is not None  # only a label has a number
    return (
        f'there are several {owner.student_id} with different numbers, this one is '
        f'{owner.label.number}: rename the folders so that each has a name of its own'
    )


def _other_spelling(student: str, known: Mapping[str, set[str]]) -> str:
    """Return a remark if another name may be this student's: the scores would be separate."""
    alike = set().union(*(known[spelling] for spelling in spellings(student))) - {student}
    return f'not the same as {", ".join(sorted(alike))}: if it is, rename one' if alike else ''
