"""All English texts of the course that are translated, by part, with their places."""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from my_robot_basics.feedback.hidden_source import without_hidden_part
from my_robot_basics.language.picture_words import PICTURES
from my_robot_basics.language.sentences import JOINED
from my_robot_basics.validate.lessons.cells import role
from nbformat import NotebookNode

from grader.authoring import index
from grader.authoring.blocks import translatable_blocks, translatable_html, without_mark_scheme
from grader.authoring.code_messages import alt_text_messages_in, messages_in, texts_passed_to
from grader.authoring.editions import is_translated
from grader.authoring.quizzes import quizzes
from grader.course import Course

Texts = dict[str, list[str]]
"""The places of each English text of a part, in reading order."""

_DRAWN_IN_LIVE = (
    *('arm', 'branches', 'follow', 'goal_view', 'graph_picture', 'qos_offers', 'qos_pictures'),
    *('queue_picture', 'service_picture', 'target', 'timeline'),
)
ONLY_DRAWN = {
    f'my_robot_basics/my_robot_basics/live/{module}.py'
    for module in (*(f'pictures/{name}' for name in _DRAWN_IN_LIVE), 'output/stdout_tap')
}
"""The modules of `live` whose texts are parts of pictures or a thread's name, no sentences."""
MODULES = {
    'checks': [
        f'my_robot_basics/my_robot_basics/{package}/*.py'
        for package in ('checks', 'checks/*', 'feedback', 'exchange', 'graph')
    ]
    + [
        f'my_robot_basics/my_robot_basics/ros2/{each}.py'
        for each in ('definition*', 'command_line')
    ],
    'validate': [
        f'my_robot_basics/my_robot_basics/{modules}.py'
        for modules in ('validate/*', 'validate/*/*')
    ],
    'live': [
        f'my_robot_basics/my_robot_basics/{modules}.py'
        for modules in ('session/*', 'ros2/environment', 'ros2/shell', 'live/*', 'live/*/*')
    ],
    'doctor': [
        f'my_robot_basics/my_robot_basics/doctor/{modules}.py'
        for modules in (
            *('inside', 'report', 'client_types', 'rules/*', 'service_rules', 'action_rules'),
        )
    ],
    'quiz': ['my_robot_basics/my_robot_basics/quiz/*.py'],
    'feedback': [
        'grader/kernels/kernel_exits.py',
        'grader/notebook/*.py',
        'grader/report/page*.py',
        'grader/report/statistics.py',
        'grader/report/similar_answers.py',
        'grader/storage/rewritten_answers.py',
        'grader/storage/save_grades.py',
    ],
}
"""The modules with texts for students, by catalogue."""
DRAWN = ('live/pictures', 'drawing', 'doctor')
"""The packages whose pictures have an alternative text."""
CHARTS = 'grader/report/charts.py'
PAGES = {'feedback': 'grader/report/page.html.j2', 'report': 'grader/report/report.html.j2'}
"""The templates of pages; texts of other modules shown there are in those modules' catalogues."""
_MARKED = re.compile(r"\b_\('((?:[^'\\]|\\.)*)'")
"""Matches a text to translate in a template."""
LAUNCHER = 'launcher'
_SAY = {'put', 'say', 'gettext_noop', 'LauncherError'}
"""Functions of the launcher's modules whose first argument is a text to translate."""
_PUT = re.compile(r'(?:\bput|fault =) "((?:[^"\\$]|\\.)+)"', re.DOTALL)
"""The same in `course`, where a backslash continues a line."""
WHEREVER = ['wherever sentences are put together']
STUDENTS = 'students.md'
"""In solutions/: the README of the students' bundle."""


def parts_of(course: Course) -> dict[str, Texts]:
    """Return the English texts of each part: lessons, pages and software."""
    parts = {name: _lesson(course, name) for name in course.assignments()}
    parts[index.PART] = {text: [index.INDEX] for text in _index(course)}
    parts |= {Path(name).stem: _notebook(quiz) for name, quiz in quizzes(course).items()}
    for page in (*index.copied_pages(course), STUDENTS):
        path = course.root / 'solutions' / page
        if path.is_file():
            blocks = translatable_blocks(path.read_text(encoding='utf-8'))
            parts[Path(page).stem] = {block: [page] for block in blocks}
    parts |= {name: texts for name, texts in _software(course).items() if texts}
    return parts


def _software(course: Course) -> dict[str, Texts]:
    """Return the texts of the software: modules, feedback page, and the lessons' checks."""
    root = course.root
    parts = {part: _modules(root, patterns) for part, patterns in MODULES.items()}
    if parts['checks']:
        parts['checks'] |= dict.fromkeys(JOINED, WHEREVER)
    parts[PICTURES] = _pictures(root)
    parts['report'] = _charts(root)
    for part, pattern in PAGES.items():
        _add_templates(parts[part], root, pattern)
    parts[LAUNCHER] = _launcher(root)
    parts['lesson_checks'], parts['hidden_checks'] = _checks_of_lessons(course)
    return parts


def _add(texts: Texts, found: Iterable[str], place: str) -> None:
    """Add the place to each of the texts."""
    for text in found:
        texts.setdefault(text, []).append(place)


def _modules(root: Path, patterns: Sequence[str]) -> Texts:
    texts: Texts = {}
    for path in sorted(path for pattern in patterns for path in root.glob(pattern)):
        place = str(path.relative_to(root))
        if place not in ONLY_DRAWN:
            _add(texts, messages_in(path.read_text(encoding='utf-8')), place)
    return texts


def _pictures(root: Path) -> Texts:
    """Return the parts of pictures' alternative texts."""
    texts: Texts = {}
    for package in DRAWN:
        for path in sorted(root.glob(f'my_robot_basics/my_robot_basics/{package}/*.py')):
            found = alt_text_messages_in(path.read_text(encoding='utf-8'))
            _add(texts, found, str(path.relative_to(root)))
    return texts


def _charts(root: Path) -> Texts:
    """Return the texts of the report's charts."""
    texts: Texts = {}
    for path in sorted(root.glob(CHARTS)):
        _add(texts, texts_passed_to(path.read_text(encoding='utf-8'), _SAY), path.name)
    return texts


def _add_templates(texts: Texts, root: Path, pattern: str) -> None:
    """Add the texts that templates of pages mark for translation."""
    for path in sorted(root.glob(pattern)):
        marked = _MARKED.findall(path.read_text(encoding='utf-8'))
        _add(texts, (text.replace("\\'", "'") for text in marked), path.name)


def _launcher(root: Path) -> Texts:
    """Return the texts of `./course` itself: of the shell script, the verbs' table and modules."""
    texts: Texts = {}
    for path in root.glob('course'):
        put = _PUT.findall(path.read_text(encoding='utf-8'))
        _add(texts, (text.replace('\\\n', '') for text in put), path.name)
    for path in root.glob('launcher/verbs.txt'):
        rows = path.read_text(encoding='utf-8').splitlines()
        helps = (re.split(r'  +', row.rstrip())[-1] for row in rows if not row.startswith('#'))
        _add(texts, helps, path.name)
    for path in sorted(root.glob('launcher/*.py')):
        found = texts_passed_to(path.read_text(encoding='utf-8'), _SAY)
        _add(texts, found, str(path.relative_to(root)))
    return texts


def _checks_of_lessons(course: Course) -> tuple[Texts, Texts]:
    """Return texts of grade cells: those that students see, and those only in hidden parts."""
    seen: Texts = {}
    hidden: Texts = {}
    for name in course.assignments():
        for cell in course.source(name).cells:
            if role(cell) == 'grade' and cell.cell_type == 'code':
                shown = messages_in(without_hidden_part(cell.source), title=True)
                for text in messages_in(cell.source, title=True):
                    _add(seen if text in shown else hidden, [text], f'{name}: {cell.id}')
    return seen, hidden


def _lesson(course: Course, name: str) -> Texts:
    texts = _notebook(course.source(name))
    for page in sorted(course.source_path(name).parent.glob('*.html')):
        _add(texts, translatable_html(page.read_text(encoding='utf-8')), page.name)
    return texts


def _notebook(notebook: NotebookNode) -> Texts:
    texts: Texts = {}
    for cell in notebook.cells:
        if is_translated(cell):
            _add(texts, translatable_blocks(without_mark_scheme(cell.source)), cell.id)
    return texts


def _index(course: Course) -> Iterator[str]:
    for text in index.TEXTS:
        yield from translatable_blocks(text)
