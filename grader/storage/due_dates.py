"""Set due dates and extensions in gradebook/deadlines.toml, and list them."""

from collections.abc import Iterator
from datetime import UTC, datetime

import tomlkit

from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.common.text import printable
from grader.course import Course
from grader.storage.deadlines import FILE, Deadlines, deadlines, read_deadlines
from grader.storage.lock import gradebook_lock


def set_due(
    course: Course, assignment: str, when: datetime | None, *, student_id: str | None = None
) -> None:
    """Set an assignment's due date, or one student's extension of it; None removes it.

    The rest of the file stays as it is, with its comments. Raises CourseError, and writes nothing,
    if the change is wrong or pointless.
    """
    path = course.gradebook / FILE
    course.expect_assignment(assignment)
    with gradebook_lock(course.gradebook):  # another process may set another date
        before = path.read_bytes() if path.exists() else b''
        now = read_deadlines(before, path, course.assignments())
        _refuse_pointless(now, assignment, when, student_id)
        document = tomlkit.parse(before.decode('utf-8-sig'))
        if student_id is None:
            _put(document, ('due',), assignment, when)
        else:
            _put(document, ('extended', assignment), student_id, when)
        after = tomlkit.dumps(document).encode()
        read_deadlines(after, path, course.assignments())
        write_whole(path, after)


def describe_deadlines(course: Course) -> Iterator[str]:
    """Yield a line for each due date, extension and rule, in this machine's time zone."""
    found = deadlines(course.gradebook, course.assignments()) or Deadlines()
    for assignment in course.assignments():
        due = found.due.get(assignment)
        yield f'{assignment}  {"due " + in_local_time(due) if due else "no due date"}'
        for (extended, student), until in sorted(found.extended.items()):
            if extended == assignment:
                yield f'  extended for {printable(student)} until {in_local_time(until)}'
    if found.per_day:
        yield (
            f'Each day late costs {found.per_day:.0%} of the score, {found.at_most:.0%} at most; '
            f'the first {found.grace_minutes:g} minutes cost nothing.'
        )
    else:
        yield (
            f'Lateness costs nothing: [late] in {FILE} can change that '
            '(docs/for-instructors.md, Due dates)'
        )


def describe_early_solutions(course: Course) -> Iterator[str]:
    """Yield a line for each lesson that somebody may still hand in, and whose answers are written.

    For example, its due date was moved after that.
    """
    found = deadlines(course.gradebook, course.assignments()) or Deadlines()
    for assignment in course.assignments():
        until = open_until(found, assignment)
        if until and (path := course.solution_path(assignment)).exists():
            yield (
                f'{path.relative_to(course.gradebook.parent)} has our answers, and {assignment} '
                f'can be handed in until {in_local_time(until)}: unless students have it '
                'already, remove it. ./course solutions writes it again after that'
            )


def open_until(found: Deadlines, assignment: str) -> datetime | None:
    """Return until when somebody may hand in, in UTC; None if that is over or has no end."""
    extended = [until for (name, _), until in found.extended.items() if name == assignment]
    last = max([*extended, found.due[assignment]]) if assignment in found.due else None
    return last if last and last > datetime.now(UTC).replace(tzinfo=None) else None


def _refuse_pointless(
    now: Deadlines, assignment: str, when: datetime | None, student_id: str | None
) -> None:
    due = now.due.get(assignment)
    extended = sorted(student for name, student in now.extended if name == assignment)
    if student_id is None and when is None and extended:
        raise CourseError(
            f'{assignment} keeps its due date: it is extended for '
            f'{printable(", ".join(extended))}. Remove these extensions first: '
            f'./course due {assignment} none --student ID'
        )
    if student_id is None or when is None:
        return
    if due is None:
        raise CourseError(
            f'{assignment} has no due date to extend: ./course due {assignment} DATE sets one'
        )
    if when.astimezone(UTC).replace(tzinfo=None) <= due:
        raise CourseError(
            f'an extension until {in_local_time(when)} gives nobody more time: {assignment} is '
            f'due {in_local_time(due)}'
        )


def _put(
    document: tomlkit.TOMLDocument, tables: tuple[str, ...], key: str, when: datetime | None
) -> None:
    around = [document]
    for name in tables:
        if name not in around[-1]:
            if when is None:
                return
            around[-1].add(name, tomlkit.table(is_super_table=name == 'extended'))
        around.append(around[-1][name])
    if when is not None:
        around[-1][key] = when
        return
    around[-1].pop(key, None)
    for outer, name in reversed(list(zip(around, tables, strict=False))):
        if not outer[name]:
            del outer[name]


def in_local_time(when: datetime) -> str:
    """Show a time in this machine's zone; without a zone it is UTC."""
    when = when if when.tzinfo else when.replace(tzinfo=UTC)
    return f'{when.astimezone():%Y-%m-%d %H:%M %Z}'
