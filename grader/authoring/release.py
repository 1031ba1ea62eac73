"""Make notebooks/ from solutions/: no answers, no hidden tests, but pictures of what is shown."""

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from grader.authoring.index import write_pages
from grader.authoring.leaks import files_in, leaks_of
from grader.authoring.release_passes import METADATA
from grader.authoring.typed_answers import keep_work
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course


def release(
    course: Course, assignment: str = '*', *, say: Callable[[str], None] = lambda line: None
) -> list[str]:
    """Release an assignment, or all of them; return the names of the files that changed.

    The index of all lessons is made anew in any case, and the page of terms copied. Everything is
    built aside first and then put in place file by file: whatever fails, notebooks/ holds whole
    files, and nothing is taken away. A notebook that somebody has worked in is copied to
    gradebook/replaced/ before, and `say` gets a line for it. Raises CourseError when a source
    can't be released.
    """
    with tempfile.TemporaryDirectory() as folder:
        built = _build(course, assignment, Path(folder))
        if leaks := [leak for name in _names(built) for leak in leaks_of(course, name, built)]:
            raise CourseError('nothing was released: ' + '; '.join(leaks))
        changed = [path for path in files_in(built) if _differs(built, course, path)]
        for line in _keep_work(course, changed):
            say(line)
        for path in changed:
            place = course.root / 'notebooks' / path
            place.parent.mkdir(parents=True, exist_ok=True)
            write_whole(place, (built / path).read_bytes())
    return [str(path) for path in changed]


def stale_or_leaking(course: Course) -> list[str]:
    """Say what is wrong with notebooks/: not what solutions/ gives today, or telling too much."""
    with tempfile.TemporaryDirectory() as folder:
        built = _build(course, '*', Path(folder))
        names = _names(built)
        stale = [
            f'notebooks/{path} is not what solutions/ gives: run ./course release'
            for path in files_in(built)
            if _differs(built, course, path)
        ]
        expected = set(files_in(built))
    released = course.root / 'notebooks'
    strange = [
        f'notebooks/{path} comes from no assignment: remove it'
        for path in files_in(released)
        if path not in expected and len(path.parts) > 1
    ]
    return stale + strange + [leak for name in names for leak in leaks_of(course, name, released)]


def _build(course: Course, assignment: str, folder: Path) -> Path:
    """Let nbgrader release into `folder`, without touching its database, and add the index."""
    if assignment != '*':
        course.source(assignment)  # names what is wrong better than nbgrader would
    elif not course.assignments():
        raise CourseError(f'there is no assignment in {course.root / "solutions"}')
    command = [
        *(sys.executable, '-m', 'nbgrader', 'generate_assignment', assignment, '--no-db'),
        f'--CourseDirectory.root={course.root}',
        f'--CourseDirectory.release_directory={folder}',
        f'--CourseDirectory.db_url=sqlite:///{folder / "unused.db"}',
    ]
    run = subprocess.run(command, cwd=course.root, capture_output=True, text=True, check=False)
    if run.returncode:
        said = [line for line in run.stderr.splitlines() if 'Error' in line or 'ERROR' in line]
        raise CourseError(
            'nbgrader could not release ' + assignment + ': ' + ' '.join(said or [run.stderr])
        )
    write_pages(course, folder, metadata=METADATA)
    return folder


def _keep_work(course: Course, changed: Sequence[Path]) -> Iterator[str]:
    """Copy the notebooks that are about to be replaced and hold somebody's work; tell of each."""
    released = {
        str(path): course.root / 'notebooks' / path for path in changed if path.suffix == '.ipynb'
    }
    copies = keep_work(released, course.gradebook / 'replaced', metadata=METADATA)
    for name, copy in copies.items():
        yield f'notebooks/{name} had been worked in: it is kept as {copy}'


def _names(built: Path) -> list[str]:
    return sorted(path.name for path in built.iterdir() if path.is_dir())


def _differs(built: Path, course: Course, path: Path) -> bool:
    released = course.root / 'notebooks' / path
    return not released.is_file() or released.read_bytes() != (built / path).read_bytes()
