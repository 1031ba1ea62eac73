"""What there is to translate: each English text of the course, in parts, with where it stands."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from my_robot_basics.feedback.hidden_source import visible
from my_robot_basics.language.picture_words import PICTURES
from my_robot_basics.language.sentences import JOINED
from my_robot_basics.validate.cells import role
from nbformat import NotebookNode

from grader.authoring import index
from grader.authoring.blocks import translatable, translatable_html, without_mark_scheme
from grader.authoring.code_messages import described_in, marked_in, messages_in
from grader.authoring.editions import is_translated
from grader.authoring.quizzes import quizzes
from grader.course import Course

Texts = dict[str, list[str]]
"""Where each English text of a part stands, in the order in which they are read."""

IN_WORDS: tuple[str, ...] = ('background', 'camera', 'commands', 'copies', 'course_nodes')
IN_WORDS += ('definition_view', 'executables', 'install_faults')
IN_WORDS += ('entry_points', 'exercise', 'package_build', 'package_faults', 'packages')
IN_WORDS += ('node_file', 'panel', 'program', 'refusals', 'runner', 'sliders', 'spinning')
IN_WORDS += ('unknown_robot', 'waiting', 'workspace')
"""The modules of `live` that say something in sentences; the others draw."""
MODULES = {
    'checks': [
        f'my_robot_basics/my_robot_basics/{package}/*.py'
        for package in ('checks', 'feedback', 'exchange', 'graph')
    ]
    + [
        f'my_robot_basics/my_robot_basics/ros2/{each}.py'
        for each in ('definition*', 'command_line')
    ],
    'validate': ['my_robot_basics/my_robot_basics/validate/*.py'],
    'live': [
        f'my_robot_basics/my_robot_basics/{module}.py'
        for module in (
            *('session/*', 'ros2/environment', 'ros2/shell'),
            *(f'live/{each}' for each in IN_WORDS),
        )
    ],
    'doctor': [
        f'my_robot_basics/my_robot_basics/doctor/{modules}.py'
        for modules in (
            *('inside', 'report', 'client_types', 'rules/*', 'service_rules/*', 'action_rules/*'),
        )
    ],
    'quiz': ['my_robot_basics/my_robot_basics/quiz/*.py'],
    'feedback': [
        'grader/kernels/kernel_exits.py',
        'grader/notebook/*.py',
        'grader/report/page*.py',
        'grader/report/statistics.py',
        'grader/report/similar_answers.py',
        'grader/storage/save_grades.py',
    ],
}
"""The modules that say something to students, for each part of the software."""
DRAWN = ('live', 'drawing', 'doctor')
"""The packages whose pictures have an alternative text."""
CHARTS = 'grader/report/charts.py'
PAGES = {'feedback': 'grader/report/page.html.j2', 'report': 'grader/report/report.html.j2'}
"""The templates of pages; what is told there of others' work is translated by its own part."""
_MARKED = re.compile(r"\b_\('((?:[^'\\]|\\.)*)'")
"""What a template marks as a text to translate."""
LAUNCHER = 'launcher'
_SAY = {'put', 'say', 'marked', 'LauncherError'}
"""What the launcher's modules give a text to that is to be translated."""
_PUT = re.compile(r'(?:\bput|fault =) "((?:[^"\\$]|\\.)+)"', re.DOTALL)
"""The same in `course`, where a backslash ends a line that goes on."""
WHEREVER = ['wherever sentences are put together']
STUDENTS = 'students.md'
"""In solutions/: the README of what students get."""


def parts_of(course: Course) -> dict[str, Texts]:
    """Return the English texts of each part: the lessons and the pages beside them."""
    parts = {name: _lesson(course, name) for name in course.assignments()}
    parts[index.PART] = {text: [index.INDEX] for text in _index(course)}
    parts |= {Path(name).stem: _notebook(quiz) for name, quiz in quizzes(course).items()}
    for page in (*index.copied_pages(course), STUDENTS):
        path = course.root / 'solutions' / page
        if path.is_file():
            blocks = translatable(path.read_text(encoding='utf-8'))
            parts[Path(page).stem] = {block: [page] for block in blocks}
    parts |= {name: texts for name, texts in _software(course).items() if texts}
    return parts


def _software(course: Course) -> dict[str, Texts]:
    """Return what the software says: its modules, the feedback page, the checks of the lessons."""
    parts = {part: _modules(course.root, patterns) for part, patterns in MODULES.items()}
    if parts['checks']:
        parts['checks'] |= dict.fromkeys(JOINED, WHEREVER)
    parts[PICTURES] = _pictures(course.root)
    parts['report'] = {}
    for path in sorted(course.root.glob(CHARTS)):
        for text in marked_in(path.read_text(encoding='utf-8'), _SAY):
            parts['report'].setdefault(text, []).append(path.name)
    for part, page in PAGES.items():
        for template in sorted(course.root.glob(page)):
            for text in _MARKED.findall(template.read_text(encoding='utf-8')):
                places = parts[part].setdefault(text.replace("\\'", "'"), [])
                places.append(template.name)
    parts[LAUNCHER] = _launcher(course.root)
    for part in ('lesson_checks', 'hidden_checks'):
        parts[part] = {}
    for name in course.assignments():
        for cell in course.source(name).cells:
            if role(cell) == 'grade' and cell.cell_type == 'code':
                shown = messages_in(visible(cell.source), title=True)
                for text in messages_in(cell.source, title=True):
                    texts = parts['lesson_checks' if text in shown else 'hidden_checks']
                    texts.setdefault(text, []).append(f'{name}: {cell.id}')
    return parts


def _launcher(root: Path) -> Texts:
    """Return what `./course` itself says: a shell script, the table of its verbs, and modules."""
    texts: Texts = {}
    for path in root.glob('course'):
        for text in _PUT.findall(path.read_text(encoding='utf-8')):
            texts.setdefault(text.replace('\\\n', ''), []).append(path.name)
    for path in root.glob('launcher/verbs.txt'):
        for row in path.read_text(encoding='utf-8').splitlines():
            if not row.startswith('#'):
                texts.setdefault(re.split(r'  +', row.rstrip())[-1], []).append(path.name)
    for path in sorted(root.glob('launcher/*.py')):
        for text in marked_in(path.read_text(encoding='utf-8'), _SAY):
            texts.setdefault(text, []).append(str(path.relative_to(root)))
    return texts


def _modules(root: Path, patterns: Sequence[str]) -> Texts:
    texts: Texts = {}
    for path in sorted(path for pattern in patterns for path in root.glob(pattern)):
        for text in messages_in(path.read_text(encoding='utf-8')):
            texts.setdefault(text, []).append(str(path.relative_to(root)))
    return texts


def _pictures(root: Path) -> Texts:
    """Return the parts of pictures' alternative texts."""
    texts: Texts = {}
    for package in DRAWN:
        for path in sorted(root.glob(f'my_robot_basics/my_robot_basics/{package}/*.py')):
            for text in described_in(path.read_text(encoding='utf-8')):
                texts.setdefault(text, []).append(str(path.relative_to(root)))
    return texts


def _lesson(course: Course, name: str) -> Texts:
    texts = _notebook(course.source(name))
    for page in sorted(course.source_path(name).parent.glob('*.html')):
        for text in translatable_html(page.read_text(encoding='utf-8')):
            texts.setdefault(text, []).append(page.name)
    return texts


def _notebook(notebook: NotebookNode) -> Texts:
    texts: Texts = {}
    for cell in notebook.cells:
        if is_translated(cell):
            for block in translatable(without_mark_scheme(cell.source)):
                texts.setdefault(block, []).append(cell.id)
    return texts


def _index(course: Course) -> Iterator[str]:
    for text in index.TEXTS:
        yield from translatable(text)
