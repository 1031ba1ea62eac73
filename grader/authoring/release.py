"""Make notebooks/ from solutions/: no answers, no hidden tests, but pictures of what is shown.

An answer is released as a stub; or as broken code, where students are to fix something. The lines
of that stand as comments right behind the answer, and take the stub's place:

    ### BEGIN SOLUTION
    self.timer = self.create_timer(0.2, self.tick)
    ### END SOLUTION
    ### BROKEN: self.timer = self.create_timer(5.0, self.tick)
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import nbformat
from my_robot_basics.validate.outputs import WIDGET_VIEW
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode

from grader.authoring.index import write_pages
from grader.authoring.leaks import BROKEN, files_in, leaks_of
from grader.authoring.typed_answers import keep_work
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course

PASSES = (
    'grader.authoring.release.TidyMetadata',
    'nbgrader.preprocessors.LockCells',
    'nbgrader.preprocessors.ClearSolutions',
    'grader.authoring.release.ReleaseBroken',
    'grader.authoring.release.KeepDemoOutputs',
    'nbgrader.preprocessors.CheckCellMetadata',
    'nbgrader.preprocessors.ComputeChecksums',
    'nbgrader.preprocessors.SaveCells',
    'grader.authoring.hidden_points.MarkHidden',
    'nbgrader.preprocessors.ClearHiddenTests',
    'nbgrader.preprocessors.ClearMarkScheme',
    'grader.authoring.hidden_points.MarkSources',
    'nbgrader.preprocessors.ComputeChecksums',
    'grader.authoring.release.LetRunAllGoOn',
    'nbgrader.preprocessors.CheckCellMetadata',
)
"""What happens to a source notebook, in order; up to SaveCells it is what the gradebook keeps."""

CODE_STUB = {'python': '# YOUR CODE HERE'}
"""What stands for an answer: it runs, so that the checks can say what is missing."""

KERNELSPEC = {'display_name': 'Python 3 (ipykernel)', 'language': 'python', 'name': 'python3'}
METADATA = {'kernelspec': KERNELSPEC, 'language_info': {'name': 'python'}}
CELL_METADATA = ('nbgrader', 'tags', 'deletable', 'editable')


class TidyMetadata(Preprocessor):
    """Keep the metadata that a lesson needs; drop what an editor or a kernel left behind."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Tidy the notebook's own metadata and that of its cells."""
        nb.metadata = nbformat.from_dict(METADATA)
        return super().preprocess(nb, resources)

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Tidy one cell."""
        kept = {key: cell.metadata[key] for key in CELL_METADATA if key in cell.metadata}
        cell.metadata = nbformat.from_dict(kept)
        return cell, resources


class ReleaseBroken(Preprocessor):
    """Put broken code, where an answer has some, in the place of the stub."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Uncomment the broken lines of one cell. Raises CourseError where they stand alone."""
        cell.source = broken(cell.source)
        return cell, resources


def broken(cleared: str) -> str:
    """Return the source of an answer cell, cleared of its answer, with its broken lines as code.

    Raises CourseError when such lines stand anywhere but right behind an answer.
    """
    stub = re.escape(CODE_STUB['python'])
    after_stub = re.compile(rf'^ *{stub}\n((?: *{BROKEN}.*(?:\n|\Z))+)', re.MULTILINE)
    source = after_stub.sub(lambda found: found[1].replace(BROKEN, ''), cleared)
    if BROKEN.strip() in source:
        raise CourseError(
            f'a line with {BROKEN.strip()!r} stands by itself: write such lines right behind'
            f' ### END SOLUTION, each beginning with {BROKEN!r}'
        )
    return source


class LetRunAllGoOn(Preprocessor):
    """Tag the cells that check answers: where one fails, JupyterLab still runs the cells below.

    Its error shows as ever. nbgrader looks at outputs alone, and what we grade and validate is
    made from solutions/, where no cell has this tag.
    """

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Tag one cell, if it is locked code: it runs an answer, or checks it."""
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('locked'):
            cell.metadata['tags'] = [*cell.metadata.get('tags', []), 'raises-exception']
        return cell, resources


class KeepDemoOutputs(Preprocessor):
    """Clear all outputs but those of demonstrations: they show on GitHub before anything runs."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Clear one cell; its number goes in any case, since it changes with each run."""
        if cell.cell_type == 'code':
            cell.execution_count = None
            if 'demo' not in cell.metadata.get('tags', ()):
                cell.outputs = []
            for output in cell.outputs:
                if output.output_type == 'execute_result':
                    output.execution_count = None
                output.get('data', {}).pop(WIDGET_VIEW, None)  # blank without its running kernel
        return cell, resources


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
