"""Make the students' zip: only files of a fixed list, all up to date, none with an answer."""

import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from my_robot_basics.language.catalogues import catalogue_path
from my_robot_basics.language.picture_words import PICTURES
from my_robot_basics.language.speaking import FOR_STUDENTS

from grader.authoring.editions import editions
from grader.authoring.index import INDEX, copied_pages
from grader.authoring.leaks import files_in, leaks_beside
from grader.authoring.quizzes import quizzes
from grader.authoring.release import stale_or_leaking
from grader.authoring.reproducible_zip import make_zip
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course

FOLDER = 'my_robot_basics_course'
"""The folder that the zip unpacks to."""
README = 'students.md'
"""In solutions/, beside the lessons: it becomes the bundle's README.md."""
AS_THEY_ARE = ('course', 'environment.txt', 'LICENSE', 'launcher/verbs.txt', 'launcher/words.sh')
LAUNCHER = 'launcher'
"""The folder of modules that `course` runs; with the files of it that are listed above."""
PINS = 'environment.txt'
OTHERS = '# --- what only the whole course needs'
"""The beginning of the line in environment.txt before which a student's part ends; .ci/pin.py
writes it."""
SETTINGS = ('.jupyterlab/overrides.json', '.jupyterlab/page_config.json')
"""The settings that `./course lab` gives JupyterLab."""
PACKAGE = 'my_robot_basics'
IN_PACKAGE: tuple[str, ...] = (
    'package.xml',
    'setup.py',
    'setup.cfg',
    'resource/my_robot_basics',
    'test/*.py',
)
IN_PACKAGE += (
    'my_robot_basics/*.py',
    'my_robot_basics/py.typed',
    'my_robot_basics/*.xml',
    'my_robot_basics/*.bash',
)
IN_PACKAGE += ('my_robot_basics/validate/labextension/*.js*',)
"""The files of a package; `*` matches `/`, too."""
INTERFACES = 'arm_interfaces'
IN_INTERFACES: tuple[str, ...] = ('package.xml', 'CMakeLists.txt', 'srv/*.srv', 'action/*.action')
IN_INTERFACES += ('wheel/*.py', 'wheel/abi3.h', 'wheel/*.whl')
PACKAGES = {PACKAGE: IN_PACKAGE, INTERFACES: IN_INTERFACES}
MADE_BY_TOOLS = ('*__pycache__*', '*.egg-info*', 'build/*', 'install/*', 'log/*')
_A_LINK = 'is a link: put the file itself in its place'
_MISSING = 'is missing: restore it'
EXECUTABLE = (f'{FOLDER}/course',)


@dataclass(frozen=True)
class Bundle:
    """A zip that was made."""

    files: tuple[str, ...]
    """Their paths in the zip."""
    bytes: int
    left_out: tuple[str, ...]
    """Files in notebooks/ that do not belong to a lesson."""


def bundle(course: Course, target: Path) -> Bundle:
    """Write the zip; the same files give the same bytes.

    Raises CourseError, and writes nothing, if the target can't be written, or if a file is
    missing, stale, not on the list, or contains an answer or a hidden test.
    """
    _check_target(target)
    if not (course.root / 'notebooks').is_dir():
        raise CourseError(
            'no bundle was made: there is no folder notebooks/: make it with ./course release'
        )
    faults = stale_or_leaking(course)
    files = dict(sorted(_contents(course, faults)))
    faults += leaks_beside(course, {n: c for n, c in files.items() if not _is_lesson(course, n)})
    if faults:
        raise CourseError('no bundle was made: ' + '; '.join(faults))
    packed = make_zip(files, EXECUTABLE)
    _check_target(target)  # checked again: reading may have created gradebook/
    target.parent.mkdir(parents=True, exist_ok=True)
    write_whole(target, packed)
    released = {f'notebooks/{path}' for path in files_in(course.root / 'notebooks')}
    left_out = sorted(released - {name.partition('/')[2] for name in files})
    return Bundle(tuple(files), len(packed), tuple(left_out))


def _check_target(target: Path) -> None:
    """Check early that a file can be written there, and that none is lost. Raises CourseError."""
    if target.is_dir():
        raise CourseError(
            f'no bundle was made: {target} is a folder; expected the file to write: '
            f'./course bundle {target / "students.zip"}'
        )
    if target.exists() and not _is_bundle(target):
        raise CourseError(
            f'no bundle was made: {target} exists, and is not a bundle that could be replaced. '
            'Move it away, or name another file: ./course bundle FILE'
        )
    above = next(each for each in target.absolute().parents if each.exists())
    try:
        with tempfile.TemporaryFile(dir=above):
            pass
    except OSError as error:
        raise CourseError(
            f'no bundle was made: {target} cannot be written, because no file '
            f'can be made in {above} ({error.strerror}). Name another file: ./course bundle FILE'
        ) from None


def _is_bundle(file: Path) -> bool:
    """Whether it was made by `bundle`; a device or a download of students' work was not."""
    if not file.is_file():
        return False
    try:
        with zipfile.ZipFile(file) as box:
            return all(name.startswith(f'{FOLDER}/') for name in box.namelist())
    except (OSError, ValueError, NotImplementedError, zipfile.BadZipFile):
        return False


def _contents(course: Course, faults: list[str]) -> Iterator[tuple[str, bytes]]:
    """Yield each file's path in the zip and its content; append what is wrong to `faults`.

    Each file is read only once, so that the content checked is the content written.
    """
    for path in _paths(course, faults):
        file = course.root / path
        if file.is_symlink() or not file.is_file():
            faults.append(f'{path} {_A_LINK if file.is_symlink() else _MISSING}')
            continue
        name = 'README.md' if path == f'solutions/{README}' else path
        content = file.read_bytes()
        if path == PINS:
            content, found, _ = content.partition(f'\n{OTHERS}'.encode())
            if not found:
                faults.append(f'{path} has no line {OTHERS!r}: run .venv/bin/python .ci/pin.py')
            content += b'\n'
        yield f'{FOLDER}/{name}', content
        if name == 'README.md':
            for edition in editions(course):
                text = edition.text(Path(README).stem, content.decode())
                yield f'{FOLDER}/README.{edition.language}.md', text.encode()


def _paths(course: Course, faults: list[str]) -> Iterator[str]:
    """Yield the paths of all files that students get, relative to the course's root."""
    yield from (*AS_THEY_ARE, *SETTINGS, f'solutions/{README}')
    modules = [path for path in files_in(course.root / LAUNCHER) if path.suffix == '.py']
    yield from (f'{LAUNCHER}/{path}' for path in modules)
    for folder in _folders(course):
        pages = (INDEX, *copied_pages(course), *quizzes(course))
        yield from (f'{folder}/{page}' for page in pages)
        for assignment in course.assignments():
            lesson = course.root / folder / assignment
            names = {f'{assignment}.ipynb', *map(str, files_in(lesson))}
            paths = (Path(assignment, name) for name in sorted(names))
            yield from (f'{folder}/{path}' for path in paths if not course.is_in_package(path))
    for edition in editions(course):
        for part in (*FOR_STUDENTS, PICTURES, LAUNCHER):
            catalogue = catalogue_path(Path('locale'), edition.language, part)
            if (course.root / catalogue).is_file():
                yield str(catalogue)
    for package, listed in PACKAGES.items():
        yield from (f'{package}/{name}' for name in listed if '*' not in name)
        for path in map(str, files_in(course.root / package)):
            if any(fnmatch(path, pattern) for pattern in MADE_BY_TOOLS):
                continue
            if not any(fnmatch(path, pattern) for pattern in listed):
                faults.append(
                    f'{package}/{path} is not in the list of files for students '
                    '(grader/authoring/bundle.py): add it there, or remove it'
                )
            elif path not in listed:
                yield f'{package}/{path}'


def _folders(course: Course) -> list[str]:
    """Return the folders of the editions, the English one first."""
    return ['notebooks', *(f'notebooks/{each.language}' for each in editions(course))]


def _is_lesson(course: Course, name: str) -> bool:
    """Whether a file was checked line by line with its own lesson."""
    return any(
        name.startswith(f'{FOLDER}/{folder}/{each}/')
        for folder in _folders(course)
        for each in course.assignments()
    )
