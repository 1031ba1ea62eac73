"""Read what a student handed in; refuse what can't be read, with the reason."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path

from my_robot_basics.session import package_files
from my_robot_basics.validate.text import printable, shorten
from nbformat import NotebookNode

from grader.common.dates import date_of
from grader.common.errors import UnreadableSubmission
from grader.common.student_names import MAX_ID_BYTES, MAX_ID_CHARACTERS, problem_of_id
from grader.notebook.reading import read_notebook

MAX_PYTHON_FILES, MAX_PYTHON_BYTES = 50, 2_000_000
"""Limits for the student's own modules together: twenty times what the whole course has."""
_MOST_NOTES, _MOST_COLUMNS = 10, 60
"""How many files that are left out are named, and how much of each name."""
TIMESTAMP = 'timestamp.txt'
"""A file beside a notebook: when it was handed in, as nbgrader writes it."""
SECRET = 'submission_secret.txt'
"""A file from nbgrader's exchange: the feedback page's name is derived from it."""
MAX_SECRET_BYTES = 1_000
"""nbgrader's secrets have 128 characters."""
LEFT_OUT = 'left_out.txt'
"""A file beside a notebook: what was not collected, one per line, with the reason."""
_MOST_LEFT_OUT_BYTES = 10_000


@dataclass(frozen=True)
class Submission:
    """One notebook of one student, as it was handed in."""

    student_id: str
    assignment: str
    path: Path
    """Where the notebook is, or should be."""
    notebook: NotebookNode | None
    """With cell types, sources, grade ids and its language only; None if it could not be read, or
    has not been read yet."""
    extra_files: tuple[Path, ...] = ()
    """The student's own Python files beside the notebook."""
    package_files: Mapping[str, Path] = field(default_factory=dict)
    """Files of ROS packages beside it, by their path: 'arm_player/setup.py'."""
    problem: str | None = None
    """Why the notebook could not be read."""
    notes: tuple[str, ...] = ()
    """What was left out, and why."""

    @property
    def files(self) -> dict[str, Path]:
        """All files except the notebook and timestamp.txt, by path."""
        return {path.name: path for path in self.extra_files} | dict(self.package_files)


def read_submission(
    folder: Path, *, student_id: str, assignment: str, packages: Sequence[str] = ()
) -> Submission:
    """Read `folder`/`assignment`.ipynb; an error becomes its `problem`.

    `packages` are the ROS packages that the lesson needs, folders beside the notebook.
    """
    return read_notebook_of(
        unread_submission(folder, student_id=student_id, assignment=assignment, packages=packages)
    )


def unread_submission(
    folder: Path, *, student_id: str, assignment: str, packages: Sequence[str] = ()
) -> Submission:
    """Return a submission with its files; its notebook is not read yet."""
    taken, notes = _python_files(folder)
    of_packages: dict[str, Path] = {}
    for name in packages:
        files, more = _package_in(folder, name)
        of_packages |= files
        notes += more
    if packages:
        notes += _left_out_before(folder)
    return Submission(
        student_id=student_id,
        assignment=assignment,
        path=folder / f'{assignment}.ipynb',
        notebook=None,
        extra_files=tuple(taken),
        package_files=of_packages,
        notes=tuple(notes),
    )


def read_notebook_of(unread: Submission) -> Submission:
    """Read the notebook of a submission and return the result; an error becomes its `problem`."""
    try:
        return replace(unread, notebook=read_notebook(unread.path))
    except UnreadableSubmission as error:
        return replace(unread, problem=str(error))


def _package_in(folder: Path, name: str) -> tuple[dict[str, Path], list[str]]:
    """Return the files of a package, by path, and notes on those that are left out."""
    place = folder / name
    if place.is_symlink():
        return {}, [f'the package `{name}` was left out: it is a link']
    if not place.is_dir():
        return {}, []
    try:
        found = package_files.read(place)
    except OSError as error:
        return {}, [f'the package `{name}` cannot be read: {error.strerror}']
    files = {f'{name}/{path}': file for path, file in found.taken.items()}
    notes = [f'of the package `{name}` was left out: {clause}' for clause in found.left_out]
    if found.problem:
        notes.insert(0, f'the package `{name}` was left out: {found.problem}')
    return files, notes


def _left_out_before(folder: Path) -> Iterator[str]:
    """Yield what `./course collect` left out."""
    path = folder / LEFT_OUT
    if path.is_symlink() or not path.is_file():
        return
    with path.open('rb') as file:
        said = file.read(_MOST_LEFT_OUT_BYTES).decode(errors='replace')
    for line in said.splitlines()[: package_files.MOST_REASONS + 2]:
        yield printable(line)[:300]


def _python_files(folder: Path) -> tuple[list[Path], list[str]]:
    """Return the plain .py files in `folder` itself, sorted, and notes on those that are left out.

    They are taken in order while they fit within MAX_PYTHON_FILES and MAX_PYTHON_BYTES.
    """
    taken: list[Path] = []
    notes: list[str] = []
    left = MAX_PYTHON_BYTES
    for path in sorted(p for p in folder.glob('*.py') if p.is_symlink() or p.is_file()):
        name, size = shorten(printable(path.name), _MOST_COLUMNS), path.lstat().st_size
        if path.is_symlink():
            notes.append(f'the file `{name}` was left out: it is a link')
        elif problem_of_id(path.name):  # the rules for students' names apply to file names, too
            notes.append(
                f'the file `{name}` was left out: its name begins with a dot, is longer than '
                f'{MAX_ID_CHARACTERS} characters or {MAX_ID_BYTES} bytes, or has '
                'characters that cannot be shown, or one of < > "'
            )
        elif size <= left and len(taken) < MAX_PYTHON_FILES:
            taken.append(path)
            left -= size
        else:
            notes.append(
                f'the file `{name}` of {size / 1e6:.1f} MB was left out: at most '
                f'{MAX_PYTHON_FILES} Python files of {MAX_PYTHON_BYTES / 1e6:.0f} MB together '
                'are taken'
            )
    if more := len(notes[_MOST_NOTES:]):
        notes[_MOST_NOTES:] = [f'{more} more Python files were left out']
    return taken, notes


def timestamps(submission: Submission) -> list[Path]:
    """Return nbgrader's timestamp.txt, if it is beside the notebook."""
    path = submission.path.with_name(TIMESTAMP)
    return [path] if path.is_file() and not path.is_symlink() else []


def exchange_files(submission: Submission) -> list[Path]:
    """Return the files of nbgrader's exchange beside the notebook: the time, and the secret."""
    secret = submission.path.with_name(SECRET)
    fits = secret.is_file() and not secret.is_symlink()
    fits = fits and secret.stat().st_size <= MAX_SECRET_BYTES
    return [*timestamps(submission), *([secret] if fits else [])]


def submission_time(submission: Submission) -> tuple[datetime | None, list[str]]:
    """Return when it was handed in (UTC, without a time zone), and notes on a damaged file."""
    if not (found := timestamps(submission)):
        return None, []
    if when := date_of(found[0]):
        return when.replace(tzinfo=None), []
    return None, [f'{TIMESTAMP} holds no date: counted as handed in on time']
