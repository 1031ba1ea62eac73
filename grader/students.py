"""Names of students, as they stand in names of files and folders."""

import re
import unicodedata

from my_robot_basics.validate.text import visible

MAX_ID_CHARACTERS, MAX_ID_BYTES = 128, 200
"""What nbgrader's database keeps of a name, and what a folder's name may be long, with a rest."""
HTML = frozenset('<>"')
"""The formgrader's tables show names as they are, in text and in attributes."""

# what course management systems put around a name: Moodle's, and Canvas's
_MOODLE = re.compile(r'(?P<who>.+?)_\d+_assignsubmission_(file|onlinetext)_?.*')
_CANVAS = re.compile(r'(?P<who>[^_]+)(_LATE)?_\d{3,}_\d{3,}(_.*)?')


class Unclear(Exception):
    """Says in a sentence why a file is nobody's."""


def student_in(name: str) -> str:
    """Return the student's name in a name. Raises Unclear."""
    name = unicodedata.normalize('NFC', name)
    if decorated := _MOODLE.fullmatch(name) or _CANVAS.fullmatch(name):
        name = decorated['who']
    name = name.strip(' ')
    if problem := problem_of_id(name):
        raise Unclear(problem)
    return name


def problem_of_id(student_id: str) -> str:
    """Say why a text can't be the name of a student's folder, if it can't."""
    if not student_id or student_id.startswith('.'):
        return 'there is no name of a student in it'
    if visible(student_id) != student_id or any(mark in student_id for mark in '/\n\t'):
        return "the student's name holds characters that can't be shown: rename it"
    if HTML.intersection(student_id):
        return 'the student\'s name holds one of < > ": the formgrader would take it for HTML'
    if len(student_id) > MAX_ID_CHARACTERS or len(student_id.encode()) > MAX_ID_BYTES:
        return f"the student's name is too long: at most {MAX_ID_CHARACTERS} characters are kept"
    return ''
