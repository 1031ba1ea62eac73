"""Where a course keeps its things: lessons, releases, the gradebook and its secret."""

import contextlib
import hashlib
import hmac
import json
import os
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.validate.packages import BUILD, packages_of
from nbformat import NotebookNode

from grader.common.checkout import ROOT as ROOT  # asked for here, as all of a course
from grader.common.db_url import configured_db_url, gradebook_of
from grader.common.errors import CourseError
from grader.notebook.lesson_text import read_lesson
from grader.notebook.restore import AssignmentTemplate, make_template


@dataclass(frozen=True)
class Course:
    """The folders of one course; a temporary gradebook may stand beside the real lessons."""

    root: Path = ROOT
    """What lies in the course's own place: solutions/, notebooks/, nbgrader_config.py."""
    gradebook: Path = ROOT / 'gradebook'
    """Submissions, scores and feedback; made by the grader, never in git."""

    @classmethod
    def at(cls, root: Path) -> 'Course':
        """Return the course whose folders all lie in `root`."""
        root = Path(root).resolve()
        return cls(root=root, gradebook=root / 'gradebook')

    @classmethod
    def of_nbgrader(cls, resources: dict) -> 'Course':
        """Return the course of which nbgrader converts a notebook: it runs in the course's root.

        The gradebook lies where the database does that it has been told to use; our own passes say
        where it lies.
        """
        at = resources['nbgrader']
        gradebook = at.get('gradebook') or gradebook_of(at['db_url'], Path.cwd())
        return cls(root=Path.cwd(), gradebook=Path(gradebook))

    @property
    def db_url(self) -> str:
        """The database's address; a writer waits up to 60 s for another one.

        It may have a password. Raises CourseError where gradebook/database.toml gives none.
        """
        return configured_db_url(self.gradebook) or f'sqlite:///{self.database}?timeout=60'

    @property
    def database(self) -> Path:
        """The file that holds lessons and scores, unless they are in PostgreSQL."""
        return self.gradebook / 'gradebook.db'

    def folder(self, step: str, student_id: str, assignment: str) -> Path:
        """Return nbgrader's folder of a submission at a step, such as 'submitted'."""
        return self.gradebook / step / student_id / assignment

    def source_path(self, assignment: str) -> Path:
        """Return where the instructor's notebook lies, answers and hidden tests included."""
        return self.root / 'solutions' / assignment / f'{assignment}.ipynb'

    def release_path(self, assignment: str) -> Path:
        """Return where the students' notebook lies."""
        return self.root / 'notebooks' / assignment / f'{assignment}.ipynb'

    def assignments(self) -> list[str]:
        """Return the names of all assignments, sorted."""
        found = (self.root / 'solutions').glob('*/*.ipynb')
        return sorted(path.stem for path in found if path.stem == path.parent.name)

    def source(self, assignment: str) -> NotebookNode:
        """Read the instructor's notebook. Raises CourseError when there is none."""
        return _read(
            self.source_path(assignment),
            self.gradebook,
            otherwise=self._unknown(assignment),
            way_out='undo the last change to it',
        )

    def release(self, assignment: str) -> NotebookNode:
        """Read the students' notebook. Raises CourseError when it was not released yet."""
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
        """Return the ROS packages that are handed in with an assignment: its locked cells say.

        Raises CourseError when there is no such assignment.
        """
        with contextlib.suppress(OSError, UnicodeDecodeError):
            if BUILD not in self.source_path(assignment).read_text(encoding='utf-8'):
                return ()  # most lessons ask for none, and need not be parsed
        return packages_of(self.source(assignment))

    def is_in_package(self, path: Path) -> bool:
        """Whether a path in solutions/ or notebooks/ leads into a package beside a lesson."""
        known = self.assignments()
        above = zip(path.parts, path.parts[1:-1], strict=False)
        return any(lesson in known and name in self.packages(lesson) for lesson, name in above)

    def seed(self, assignment: str, student_id: str) -> str:
        """Return the hexadecimal seed of the inputs that an assignment's hidden tests choose.

        It is a student's own, the same at each hand-in and each re-grading, and another one once
        the lesson's text changes; nobody without the course's secret can tell it. Raises
        CourseError where that secret is damaged.
        """
        return self.seeds(assignment)(student_id)

    def seeds(self, assignment: str) -> Callable[[str], str]:
        """Return what gives each student's seed of an assignment: the lesson is read only once."""
        version, secret = self.version(assignment), self._secret()

        def seed(student_id: str) -> str:
            # as JSON: no name can then be taken for a part of another one
            text = json.dumps([assignment, version, student_id])
            return hmac.new(secret, text.encode('ascii'), hashlib.sha256).hexdigest()

        return seed

    def version(self, assignment: str) -> str:
        """Return a hash of what the lesson says: outputs and layout don't count."""
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
                # whole or not at all, and one only where two begin at once
                with contextlib.suppress(FileExistsError):
                    os.link(fresh, path)
            finally:
                fresh.unlink(missing_ok=True)
        try:
            secret = bytes.fromhex(path.read_text(encoding='ascii'))
        except ValueError:
            secret = b''
        if not secret:  # with an empty one, anybody could tell the seeds
            raise CourseError(
                f'{path} is damaged: expected hexadecimal digits. Restore it from a backup; a '
                'new secret, which is made where there is no such file, gives hidden tests other '
                'inputs.'
            )
        return secret

    def expect_assignment(self, name: str) -> None:
        """Raise CourseError where there is no assignment of that name."""
        if name not in self.assignments():
            raise CourseError(self._unknown(name))

    def _unknown(self, assignment: str) -> str:
        known = ', '.join(self.assignments()) or 'none'
        return f'there is no assignment {assignment!r} in solutions/; there are: {known}'


def _read(path: Path, gradebook: Path, *, otherwise: str, way_out: str) -> NotebookNode:
    try:
        return read_lesson(path.read_text(encoding='utf-8'), gradebook)
    except FileNotFoundError:
        raise CourseError(otherwise) from None
    except ValueError as error:
        raise CourseError(f'{path} is not a notebook: {error}; {way_out}') from None
