"""What the documents name exists: their paths, modules, links, and one version for all parts."""

import json
import re
import tomllib
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree

import pytest
from my_robot_basics.session import package_files
from my_robot_basics.validate.kernels import limits as cell_limits
from my_robot_basics.validate.kernels import timeouts
from my_robot_basics.validate.kernels.outputs import MAX_OUTPUT_CHARACTERS
from my_robot_basics.validate.lessons.names import MAX_SOURCE_CHARACTERS

from grader.collect import uploads
from grader.common import dates
from grader.notebook import raw_notebook
from grader.report import feedback, formgrader, similar_answers
from grader.sandbox import limits
from grader.sandbox.system_calls import ALLOWED

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'my_robot_basics/my_robot_basics'
DOCUMENTS = [
    path for where in ('*', 'docs/*', 'deploy/*/*') for path in sorted(ROOT.glob(f'{where}.md'))
]
FOLDERS = (ROOT, PACKAGE.parent, PACKAGE)
"""A path may begin in the repository's root, or in the package that students import."""
KNOWN = {path.name for folder in FOLDERS for path in folder.iterdir() if path.is_dir()} - {
    '.git',
    '.venv',
    'gradebook',  # made by the grader
    'ros_ws',
}
NEW = re.compile('example|docs/reference/|(locale|notebooks)/de/')
"""Files and folders that a document tells its reader to make."""
PATH = re.compile(r'(?<![\w/.:~$-])([\w.]+)(/[\w./*-]*[\w/*])')
MODULE = re.compile(r'(?<![\w/.@-])((?:grader|my_robot_basics|launcher)(?:\.[a-z_]\w*)+)')
LINK = re.compile(r'\]\((?!https?:)([^)\s]+)\)|(?:src|href)="(?!https?:)([^"]+)"')


def paths_in(text):
    """Yield what looks like a path of ours: its first part is one of our folders."""
    for first, rest in PATH.findall(re.sub(r'https?:\S+', '', text)):
        if first in KNOWN and not NEW.search(first + rest):
            yield first + rest


def modules_in(text):
    yield from (name for name in MODULE.findall(text) if not NEW.search(name))


def is_there(path):
    return any(any(folder.glob(path.rstrip('/'))) for folder in FOLDERS)


def is_named(dotted):
    """Whether that is a module, or a name that a module's text holds."""
    if find_spec(dotted.partition('.')[0]) is None:
        return False
    try:
        if find_spec(dotted):
            return True
    except ModuleNotFoundError:
        pass
    module, _, name = dotted.rpartition('.')
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        return False
    return bool(spec and spec.origin) and name in re.findall(r'\w+', Path(spec.origin).read_text())


@pytest.fixture(params=DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def document(request):
    return request.param


def test_each_path_that_a_document_names_exists(document):
    assert [path for path in paths_in(document.read_text()) if not is_there(path)] == []


def test_each_module_that_a_document_names_exists(document):
    assert [name for name in modules_in(document.read_text()) if not is_named(name)] == []


def test_each_link_leads_to_a_file_or_a_heading(document):
    broken = []
    for link in (''.join(both) for both in LINK.findall(document.read_text())):
        path, _, heading = link.partition('#')
        target = document.parent / path if path else document
        if not target.exists() or (heading and heading not in headings_of(target)):
            broken.append(link)
    assert broken == []


def headings_of(path):
    """Return the anchors that GitHub gives the headings of a page."""
    titles = re.findall(r'^#+ (.+)$', path.read_text(), re.MULTILINE)
    return {re.sub(r'[^\w\- ]', '', title.lower()).replace(' ', '-') for title in titles}


def test_the_patterns_find_paths_modules_and_tests_in_documents():
    text = (ROOT / 'README.md').read_text()
    assert 'tests/benchmarks/class_of_500.py' in {*paths_in(text)}
    assert 'gradebook/scores.csv' not in {*paths_in(text)}
    reasons = (ROOT / 'docs/decisions.md').read_text()
    assert len(TEST.findall(reasons)) > 5
    assert len(ROWS.findall(' '.join(reasons.split()))) > 5
    assert {*modules_in('see grader.cli.verbs and launcher.lab')} == {
        'grader.cli.verbs',
        'launcher.lab',
    }
    assert is_there('live/__init__.py')
    assert not is_there('grader/never.py')
    assert is_named('grader.course.Course')
    assert not is_named('grader.course.Nothing')
    assert not is_named('grader.never.Nothing')


TEST = re.compile(r'`(test_\w+)`')
ROWS = re.compile(r'((?:`\w+`(?:,| and)? )+)(?:and others )?in `(tests/[\w/]+(?:\.\w+|/))`')
"""Names of a table of tests, or of files in a folder of them, and where they are."""


def test_each_test_that_a_document_names_exists(document):
    tests = '\n'.join(path.read_text() for path in sorted(ROOT.glob('tests/test_*.py')))
    known = set(re.findall(r'^def (test_\w+)', tests, re.MULTILINE))
    assert [name for name in TEST.findall(document.read_text()) if name not in known] == []


def test_each_row_of_a_table_of_tests_that_a_document_names_exists(document):
    found = ROWS.findall(' '.join(document.read_text().split()))
    rows = [(name, ROOT / place) for text, place in found for name in re.findall('`(.+?)`', text)]
    assert [name for name, place in rows if name not in names_in(place)] == []


def names_in(place):
    """Return the words of a table, or the names of a folder's files."""
    if place.is_dir():
        return {path.stem for path in place.iterdir()}
    return {*re.findall(r'\w+', place.read_text())}


# --- figures that the code decides ---------------------------------------------------------------

FIGURES = {
    'SECURITY.md': [
        f'{uploads.LIMITS_OF_ONE.cpu_sec} s of processor time and '
        f'{uploads.LIMITS_OF_ONE.memory_bytes // 2**30} GB for each',
        f'{raw_notebook.MAX_NOTEBOOK_BYTES // 10**6} MB, {raw_notebook.MAX_CELLS:,} cells, '
        f'{raw_notebook.MAX_CHARACTERS:,} characters, {raw_notebook.MAX_PICTURES} pictures',
        f'which holds no gradebook; {MAX_SOURCE_CHARACTERS:,} characters',
        f'{cell_limits.MAX_MESSAGE_BYTES // 10**6} MB, {cell_limits.MAX_MESSAGE_PARTS:,} parts, '
        f'{MAX_OUTPUT_CHARACTERS:,} characters a cell',
        f'in linear time, {cell_limits.MAX_REPLY_CHARACTERS:,} characters',
        f'{formgrader.LIMITS.cpu_sec} or {feedback.LIMITS.cpu_sec} s of processor time',
        f'{similar_answers.LIMITS.cpu_sec} s for each exercise; answers of up to '
        f'{similar_answers.MOST_CHARACTERS:,} characters',
        f'outputs of {cell_limits.MAX_NOTEBOOK_OUTPUT_CHARACTERS:,} characters together',
        f'one regular expression, {dates.MAX_BYTES} bytes',
        f'at most {package_files.MAX_FILES} files and {package_files.MAX_BYTES // 10**6} MB',
    ],
    'docs/for-instructors.md': [f'{limits.SUBMISSION_MEMORY_BYTES // 2**20} MB are reserved for'],
    'docs/capacity.md': [
        f'does not return within {cell_limits.VALIDATE_TIMEOUT_SEC} s',
        f'grading gives it {cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s',
    ],
    'docs/architecture.md': [
        f'{cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s for a cell, '
        f'{cell_limits.BUILD_TIMEOUT_SEC:.0f} s for one that builds a package; up to '
        f'{timeouts.MOST_TIMES * cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s for one that works',
        f'{cell_limits.CHECK_TIMEOUT_SEC:.0f} s each at most',
    ],
    'docs/grading-a-package.md': [
        f'this cell has {cell_limits.BUILD_TIMEOUT_SEC:.0f} s instead of '
        f'{cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s',
        f'If it takes over {cell_limits.BUILD_TIMEOUT_SEC:.0f} s, it is done again',
    ],
    'docs/decisions.md': [
        f'A list of {len(ALLOWED)} names and numbers',
        f'given up after {cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s as before; '
        f'others have up to {timeouts.MOST_TIMES * cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s',
        f'A build has {cell_limits.BUILD_TIMEOUT_SEC:.0f} s',
        f'gives up a cell or a function after {cell_limits.VALIDATE_TIMEOUT_SEC} s',
        f'grading waits {cell_limits.STUDENT_CELL_TIMEOUT_SEC:.0f} s. The checks of an exercise '
        f'have {cell_limits.VALIDATE_CHECKS_SEC:.0f} s of free time together, and '
        f'{cell_limits.VALIDATE_CHECKS_MOST_SEC:.0f} s at most',
    ],
}


@pytest.mark.parametrize('name', FIGURES)
def test_a_limit_that_a_document_names_is_that_of_the_code(name):
    text = ' '.join((ROOT / name).read_text(encoding='utf-8').split())
    assert [figure for figure in FIGURES[name] if figure not in text] == []


# --- one version ---------------------------------------------------------------------------------


def test_all_parts_have_one_version():
    project = tomllib.loads((ROOT / 'pyproject.toml').read_text())['project']['version']
    manifest = ElementTree.parse(ROOT / 'my_robot_basics/package.xml').findtext('version')
    (setup,) = re.findall(
        r"^    version='(.+)',$", (ROOT / 'my_robot_basics/setup.py').read_text(), re.MULTILINE
    )
    extension = json.loads((PACKAGE / 'validate/labextension/package.json').read_text())['version']
    changes = (ROOT / 'CHANGELOG.md').read_text(encoding='utf-8')
    latest = re.search(r'^## \[(\d.*?)\]', changes, re.MULTILINE)[1]
    assert {project, manifest, setup, extension, latest} == {project}
