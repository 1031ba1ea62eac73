"""Which answers passed in *Validate*: a small file, only on the student's own machine.

It is in Jupyter's user data folder, not beside the lessons: those may be read-only, are replaced
by a new bundle, and exist once for each language. The file stores a hash of each answer and its
checks, but no answer. Only the student's own pages read it: it is not part of a submission, and
the grader does not use it.
"""

import fcntl
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from jupyter_core.paths import jupyter_data_dir
from nbformat import NotebookNode

from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.lessons.cells import fingerprint
from my_robot_basics.validate.lessons.exercises import Exercise

SCHEMA = 1
MOST_OF_ONE = 20
"""How many answers are kept for each exercise, the latest ones."""


@dataclass(frozen=True)
class Pass:
    """An answer that passed all visible checks of its exercise."""

    answer: str
    """See `answer_of`."""
    notebook: str
    """The path of its notebook."""
    passed_at: str
    """In UTC, ISO 8601."""


Passes = dict[str, dict[str, list[Pass]]]
"""Passed answers by lesson and exercise, the latest at the end."""


class DamagedFile(CourseError):
    """The file exists, but cannot be parsed."""


class NewerFile(CourseError):
    """The file was written by a newer version of the course."""


def default_path() -> Path:
    """Return the path of this user's file."""
    return Path(jupyter_data_dir()) / 'my_robot_basics' / 'passed_answers.json'


def answer_of(notebook: NotebookNode, exercise: Exercise, folder: Path) -> str:
    """Return a hash of an answer together with its checks.

    `folder` is the notebook's: its packages belong to the answer, without the files of builds.
    """
    cells = [notebook.cells[i] for i in (exercise.answer, *exercise.grades)]
    said = [cell.source.strip() for cell in cells]
    for name in exercise.packages:
        for path in sorted((folder / name).rglob('*')):
            parts = path.relative_to(folder).parts
            if path.is_file() and not any(p.startswith(('.', '__pycache__')) for p in parts):
                said += ['/'.join(parts), _hash_of(path)]
    return fingerprint('\0'.join(said))


def _hash_of(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        return f'not read: {error.strerror}'  # the build says so, too


def read_passes(path: Path) -> Passes:
    """Return the passed answers; {} if there is no file yet. Raises CourseError."""
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise CourseError(
            f'your progress cannot be read: {path}: {error.strerror}; Validate works all the same'
        ) from None
    try:
        data = json.loads(raw)
        if data['schema'] > SCHEMA:
            raise NewerFile(
                f'{path} was written by a newer version of the course, and is left as it is: '
                'start the newer version to see your progress'
            )
        return {
            str(lesson): {
                str(name): [Pass(**{key: str(of[key]) for key in of}) for of in passes]
                for name, passes in exercises.items()
            }
            for lesson, exercises in data['lessons'].items()
        }
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise DamagedFile(
            f'{path} is damaged, so your progress is not shown: when you press Validate, the file '
            'is kept under another name, and a new one begins'
        ) from None


def record(
    path: Path, lesson: str, results: Mapping[str, tuple[str, bool]], notebook: Path
) -> tuple[str, ...]:
    """Record, for each exercise by name, its answer and whether that passed.

    An answer that fails now is removed from the passed ones. Returns sentences for the student:
    why nothing could be written, or what happened to a damaged file.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with _locked(path.parent):
            passes, notes = _read_to_write(path)
            of_lesson = passes.setdefault(lesson, {})
            for name, (answer, has_passed) in results.items():
                kept = [each for each in of_lesson.get(name, []) if each.answer != answer]
                if has_passed:
                    now = datetime.now(UTC).isoformat(timespec='seconds')
                    kept.append(Pass(answer, str(notebook.absolute()), now))
                of_lesson[name] = kept[-MOST_OF_ONE:]
            _write(path, passes)
    except OSError as error:
        why = error.strerror or str(error)
        return (f'your progress could not be written: {path}: {why}; the checks are not affected',)
    except CourseError as error:
        return (str(error),)
    return notes


def _read_to_write(path: Path) -> tuple[Passes, tuple[str, ...]]:
    """Return the passed answers; a damaged file is renamed, and a sentence gives its new name."""
    try:
        return read_passes(path), ()
    except DamagedFile:
        numbers = iter(range(1, 1000))
        aside = path
        while aside.exists():
            aside = path.with_name(f'{path.stem}.damaged-{next(numbers)}{path.suffix}')
        path.rename(aside)
        return {}, (
            f'the file with your progress was damaged: it is kept as {aside}, and a new one has '
            'begun; press Validate once in each lesson that you have finished',
        )


def _write(path: Path, passes: Passes) -> None:
    """Write the file atomically, so that no reader finds half of it."""
    lessons = {
        lesson: {name: [asdict(each) for each in found] for name, found in exercises.items()}
        for lesson, exercises in passes.items()
    }
    aside = path.with_name(f'.{path.name}.{os.getpid()}')
    try:
        with aside.open('w', encoding='utf-8') as file:
            json.dump({'schema': SCHEMA, 'lessons': lessons}, file, indent=1)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Let one Validate write at a time; on a file system without locks, the last one wins."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
