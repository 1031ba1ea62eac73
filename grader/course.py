"""Where a course keeps its files: lessons, releases, the gradebook and its secret."""

import contextlib
import hashlib
import hmac
import json
import os
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.validate.lessons.packages import BUILD, packages_of
from nbformat import NotebookNode

from grader.common.checkout import ROOT as ROOT  # other modules import it from here
from grader.common.db_url import configured_db_url, gradebook_of
from grader.common.errors import CourseError
from grader.notebook.lesson_text import read_lesson
from grader.notebook.restore import AssignmentTemplate, make_template


@dataclass(frozen=True)
class Course:
    """The folders of one course; a temporary gradebook may be used with the real lessons."""

    root: Path = ROOT
    """The folder that contains solutions/, notebooks/ and nbgrader_config.py."""
    gradebook: Path = ROOT / 'gradebook'
    """Submissions, scores and feedback; made by the grader, never in git."""

    @classmethod
    def at(cls, root: Path) -> 'Course':
        """Return the course whose folders are all in `root`."""
        root = Path(root).resolve()
        return cls(root=root, gradebook=root / 'gradebook')

    @classmethod
    def of_nbgrader(cls, resources: dict) -> 'Course':
        """Return the course whose notebook nbgrader converts: nbgrader runs in the course's root.

        The gradebook is beside the database that nbgrader was told to use; our own preprocessors
        name its folder in `resources`.
        """
        at = resources['nbgrader']
        gradebook = at.get('gradebook') or gradebook_of(at['db_url'], Path.cwd())
        return cls(root=Path.cwd(), gradebook=Path(gradebook))

    @property
    def db_url(self) -> str:
        """The database's URL; with SQLite, a writer waits up to 60 s for another writer.

        The URL may contain a password. Raises CourseError if gradebook/database.toml has no URL.
        """
        return configured_db_url(self.gradebook) or f'sqlite:///{self.database}?timeout=60'

    @property
    def database(self) -> Path:
        """The SQLite file of lessons and scores; not used if they are in PostgreSQL."""
        return self.gradebook / 'gradebook.db'

    def folder(self, step: str, student_id: str, assignment: str) -> Path:
        """Return nbgrader's folder of a submission at a step, such as 'submitted'."""
        return self.gradebook / step / student_id / assignment

    def source_path(self, assignment: str) -> Path:
        """Return the path of the instructor's notebook, with answers and hidden tests."""
        return self.root / 'solutions' / assignment / f'{assignment}.ipynb'

    def release_path(self, assignment: str) -> Path:
        """Return the path of the students' notebook."""
        return self.root / 'notebooks' / assignment / f'{assignment}.ipynb'

    def solution_path(self, assignment: str) -> Path:
        """Return the path of the notebook with our answers, to give out after the deadline."""
        return self.gradebook / 'solutions' / f'{assignment}.ipynb'

    def assignments(self) -> list[str]:
        """Return the names of all assignments, sorted."""
        found = (self.root / 'solutions').glob('*/*.ipynb')
        return sorted(path.stem for path in found if path.stem == path.parent.name)

    def source(self, assignment: str) -> NotebookNode:
        """Read the instructor's notebook. Raises CourseError if there is none."""
        return _read(
            self.source_path(assignment),
            self.gradebook,
            otherwise=self._unknown(assignment),
            way_out='undo the last change to it',
        )

    def release(self, assignment: str) -> NotebookNode:
        """Read the students' notebook. Raises CourseError if it was not released yet."""
        way_out = f'run ./course release {assignment}'
        return _read(
            self.release_path(assignment),
            self.gradebook,
            otherwise=f'{assignment} is not released yet: {way_out}',
            way_out=way_out,
        )

    def template(self, assignment: str) -> AssignmentTemplate:
        """Return what submissions of an assignment are restored from."""
        return make_template(self.source(assignment), self.release(assignment))

    def packages(self, assignment: str) -> tuple[str, ...]:
        """Return the ROS packages handed in with an assignment, as its locked cells list them.

        Raises CourseError if there is no such assignment.
        """
        with contextlib.suppress(OSError, UnicodeDecodeError):
            if BUILD not in self.source_path(assignment).read_text(encoding='utf-8'):
                return ()  # most lessons ask for no package, and need not be parsed
        return packages_of(self.source(assignment))

    def is_in_package(self, path: Path) -> bool:
        """Whether a path in solutions/ or notebooks/ leads into a lesson's ROS package."""
        known = self.assignments()
        above = zip(path.parts, path.parts[1:-1], strict=False)
        return any(lesson in known and name in self.packages(lesson) for lesson, name in above)

    def seed(self, assignment: str, student_id: str) -> str:
        """Return the hexadecimal seed of the inputs that an assignment's hidden tests choose.

        Each student has a seed of their own. It stays the same when the student hands in or is
        graded again, and changes when the lesson's text changes. To compute it, one needs the
        course's secret. Raises CourseError if that secret is damaged.
        """
        return self.seeds(assignment)(student_id)

    def seeds(self, assignment: str) -> Callable[[str], str]:
        """Return a function from student ID to seed: the lesson is read only once."""
        version, secret = self.version(assignment), self._secret()

        def seed(student_id: str) -> str:
            # as JSON: the end of one part can't be read as the beginning of the next
            text = json.dumps([assignment, version, student_id])
            return hmac.new(secret, text.encode('ascii'), hashlib.sha256).hexdigest()

        return seed

    def version(self, assignment: str) -> str:
        """Return a hash of the lesson's cells; outputs and layout don't count."""
        cells = [
            (cell.cell_type, cell.source, cell.metadata.get('nbgrader', {}))
            for cell in self.source(assignment).cells
        ]
        return hashlib.sha256(json.dumps(cells, sort_keys=True).encode()).hexdigest()

    def _secret(self) -> bytes:
        path = self.gradebook / 'course_secret'
        if not path.exists():
            self.gradebook.mkdir(parents=True, exist_ok=True)
            fresh = path.with_name(f'.course_secret.{secrets.token_hex(8)}')
            try:
                fresh.touch(mode=0o600)
                fresh.write_text(secrets.token_hex(32), encoding='ascii')
                # complete or not at all; of two processes that begin at once, one creates it
                with contextlib.suppress(FileExistsError):
                    os.link(fresh, path)
            finally:
                fresh.unlink(missing_ok=True)
        try:
            secret = bytes.fromhex(path.read_text(encoding='ascii'))
        except ValueError:
            secret = b''
        if not secret:  # with an empty secret, anybody could compute the seeds
            raise CourseError(
                f'{path} is damaged: expected hexadecimal digits. Restore it from a backup; a '
                'new secret, which is made where there is no such file, gives hidden tests other '
                'inputs.'
            )
        return secret

    def expect_assignment(self, name: str) -> None:
        """Raise CourseError if there is no assignment of that name."""
        if name not in self.assignments():
            raise CourseError(self._unknown(name))

    def _unknown(self, assignment: str) -> str:
        known = ', '.join(self.assignments()) or 'none'
        return f'there is no assignment {assignment!r} in solutions/; there are: {known}'


def _read(path: Path, gradebook: Path, *, otherwise: str, way_out: str) -> NotebookNode:
    text = ''
    try:
        return read_lesson(text := path.read_text(encoding='utf-8'), gradebook)
    except FileNotFoundError:
        raise CourseError(otherwise) from None
    except ValueError as error:
        if '\n<<<<<<< ' in text:
            raise CourseError(
                f'{path} has two versions in it, which git could not merge: keep yours with '
                f"git checkout --ours '{path}', or take the other with --theirs; then run "
                './course release'
            ) from None
        raise CourseError(f'{path} is not a notebook: {error}; {way_out}') from None
