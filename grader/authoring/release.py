"""Make notebooks/ from solutions/: without answers and hidden tests, with demonstration outputs.

The pictures move to notebooks/: solutions/ keeps only what nbval compares (see demo_outputs).
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import nbformat
from nbformat import NotebookNode

from grader.authoring.demo_outputs import Sanitize, clean_source, keep_outputs, read_sanitizer
from grader.authoring.edition_files import write_editions
from grader.authoring.editions import editions
from grader.authoring.index import write_pages
from grader.authoring.leaks import files_in, leaks_of
from grader.authoring.quizzes import unknown_quizzes
from grader.authoring.release_passes import METADATA
from grader.authoring.source_faults import refuse_faulty, refuse_misnamed
from grader.authoring.typed_answers import keep_work
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course


def release(
    course: Course,
    assignment: str = '*',
    *,
    fresh_outputs: bool = False,
    say: Callable[[str], None] = lambda line: None,
) -> list[str]:
    """Release an assignment, or all of them; return the names of the files that changed.

    Outputs of demonstrations in the last release stay if they are still valid, unless
    `fresh_outputs` asks for the outputs that the notebooks in solutions/ have. The contents page
    is always made anew, and the pages are copied.

    Everything is built in a temporary folder, then each changed file is replaced atomically: if
    something fails, notebooks/ has only complete files; no file is removed. A notebook that
    somebody has worked in is first copied to gradebook/replaced/, and `say` gets a line for it.
    Raises CourseError if a source can't be released.
    """
    with tempfile.TemporaryDirectory() as folder:
        built = _build(course, assignment, Path(folder))
        for line in _keep_outputs(course, built, fresh=fresh_outputs):
            say(line)
        write_editions(course, _names(course, built), built, metadata=METADATA, say=say)
        if leaks := _leaks(course, built):
            raise CourseError(
                f'nothing was released: {"; ".join(leaks)}; take these lines out of all cells but'
                ' the answer and the hidden part'
            )
        changed = [path for path in files_in(built) if _differs(built, course, path)]
        for line in _keep_work(course, changed):
            say(line)
        for path in changed:
            place = course.root / 'notebooks' / path
            place.parent.mkdir(parents=True, exist_ok=True)
            write_whole(place, (built / path).read_bytes())
        for name in _names(course, built):
            if (cleaned := _cleaned_source(course, name)) is not None:
                write_whole(course.source_path(name), cleaned)
                say(f'{_source_name(name)} holds no pictures any more: they are in notebooks/ now')
    return [str(path) for path in changed]


def stale_or_leaking(course: Course) -> list[str]:
    """Return what is wrong with notebooks/: differences from solutions/, and leaks."""
    with tempfile.TemporaryDirectory() as folder:
        built = _build(course, '*', Path(folder))
        list(_keep_outputs(course, built))
        names = _names(course, built)
        write_editions(course, names, built, metadata=METADATA)
        stale = [
            f'notebooks/{path} differs from what solutions/ gives: run ./course release'
            for path in files_in(built)
            if _differs(built, course, path)
        ]
        expected = set(files_in(built))
    stale += [
        f'{_source_name(name)} holds pictures, times or measured values: run ./course release'
        for name in names
        if _cleaned_source(course, name) is not None
    ]
    released = course.root / 'notebooks'
    strange = [
        f'notebooks/{path} belongs to no assignment: remove it'
        for path in files_in(released)
        if path not in expected and len(path.parts) > 1 and not course.is_in_package(path)
    ]
    return stale + strange + _leaks(course, released)


def _build(course: Course, assignment: str, folder: Path) -> Path:
    """Let nbgrader release into `folder`, without touching its database, and add the pages."""
    names = course.assignments() if assignment == '*' else [assignment]
    if not names:
        raise CourseError(f'there is no assignment in {course.root / "solutions"}')
    refuse_misnamed(course)
    refuse_faulty(course, names)
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
    for name in names:  # a ROS package beside the source is the answer
        for package in course.packages(name):
            shutil.rmtree(folder / name / package, ignore_errors=True)
    write_pages(course, folder, metadata=METADATA)
    return folder


def _keep_outputs(course: Course, built: Path, *, fresh: bool = False) -> Iterator[str]:
    """Keep valid outputs in built notebooks; yield a message for each cell that should be run."""
    yield from unknown_quizzes(course)
    sanitize = sanitizer_of(course)
    for name in _names(course, built):
        path = built / name / f'{name}.ipynb'
        notebook = nbformat.read(path, as_version=4)
        before = last_release(course, name)
        doubtful = keep_outputs(notebook, before, sanitize, fresh=fresh)
        write_whole(path, nbformat.writes(notebook) + '\n')
        for cell in doubtful:
            why = (
                'its code has changed, and its picture has not. Run the lesson in JupyterLab, '
                'save it, and release it again'
                if before.cells
                else f'its picture is missing, because notebooks/{name}/{name}.ipynb could not be '
                'read. Take that file back from git, or run the lesson in JupyterLab and save it; '
                'then release it again'
            )
            yield f'{_source_name(name)}, cell {cell!r}: {why}'


def _leaks(course: Course, released: Path) -> list[str]:
    """Return messages on answers and hidden tests in the released lessons of all languages."""
    folders = [released, *(released / edition.language for edition in editions(course))]
    leaks = (
        leak
        for folder in folders
        for name in _names(course, folder)
        for leak in leaks_of(course, name, folder)
    )
    return [*dict.fromkeys(leaks)]


def last_release(course: Course, name: str) -> NotebookNode:
    """Return the notebook that is now in notebooks/, or an empty one."""
    try:
        return nbformat.read(course.release_path(name), as_version=4)
    except (OSError, ValueError, nbformat.ValidationError):
        return nbformat.v4.new_notebook()  # a damaged file is replaced anyway


def _cleaned_source(course: Course, name: str) -> str | None:
    """Return a source in its stored form; None if it has that form already."""
    source = course.source(name)
    cleaned = clean_source(source, sanitizer_of(course))
    return None if cleaned == source else nbformat.writes(cleaned) + '\n'


def sanitizer_of(course: Course) -> Sanitize:
    """Return the function that normalises outputs before nbval compares them."""
    return read_sanitizer(course.root / 'solutions/nbval_sanitize.cfg')


def _source_name(name: str) -> str:
    return f'solutions/{name}/{name}.ipynb'


def _keep_work(course: Course, changed: Sequence[Path]) -> Iterator[str]:
    """Copy notebooks that are about to be replaced if they contain work; yield a line for each."""
    released = {
        str(path): course.root / 'notebooks' / path for path in changed if path.suffix == '.ipynb'
    }
    copies = keep_work(released, course.gradebook / 'replaced', metadata=METADATA)
    for name, copy in copies.items():
        yield f'notebooks/{name} was replaced, but contained work: it is kept as {copy}'


def _names(course: Course, built: Path) -> list[str]:
    """Return the assignments in a folder, sorted by name."""
    return [name for name in course.assignments() if (built / name).is_dir()]


def _differs(built: Path, course: Course, path: Path) -> bool:
    released = course.root / 'notebooks' / path
    return not released.is_file() or released.read_bytes() != (built / path).read_bytes()
