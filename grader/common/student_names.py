"""Names of students, as they stand in names of files and folders."""

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

from my_robot_basics.validate.text import visible

MAX_ID_CHARACTERS, MAX_ID_BYTES = 128, 200
"""What nbgrader's database keeps of a name, and what a folder's name may be long, with a rest."""
HTML = frozenset('<>"')
"""The formgrader's tables show names as they are, in text and in attributes."""
MOST_WORDS = 4
"""The words of a name are tried in each order where they are written as one; more are not."""

# What course management systems put around a name. Neither leaves an underscore in the name, and
# what stands behind it is the name that the student gave the file.
_MOODLE = re.compile(
    r'(?P<who>.+?)_(?P<number>\d+)_assignsubmission_(file|onlinetext)_?(?P<rest>.*)'
)
_CANVAS = re.compile(
    r'(?P<who>[^_]+)(_LATE)?_(?P<number>\d{3,})_(?P<upload>\d{3,})(_(?P<rest>.*))?', re.I
)
_ANONYMOUS = {'Participant', 'Teilnehmer', 'Teilnehmerin'}
"""What Moodle calls everybody where teachers must not know who it was."""
_UPLOADS = """
    notebooks submitted submissions submission inbound assignment assignments homework hw task
    tasks exercise exercises solution solutions answer answers lab labs lesson lessons project
    upload uploads download downloads files folder archive zip week term semester class course
    students abgabe abgaben aufgabe aufgaben hausaufgabe hausaufgaben übung übungen lösung
    lösungen woche kurs devoir devoirs exercice exercices travail rendu semaine tarea tareas
    ejercicio ejercicios entrega semana trabajo compito compiti esercizio esercizi 作业 作業
    """
_WORDS_OF_NOBODY = frozenset(_UPLOADS.split())
_BESIDE_THEM = frozenset(
    {'my', 'the', 'final', 'of', 'for', 'ros', 'jupyter', 'meine', 'mes', 'mis'}
)


class Unclear(Exception):
    """Says in a sentence why a file is nobody's."""


@dataclass(frozen=True)
class Label:
    """What a course management system wrote before the name of a file, or as a folder's name."""

    platform: str
    """'moodle' or 'canvas'."""
    number: str
    """Moodle's of a student in one assignment, Canvas's of a student."""
    who: str
    rest: str
    """What the student called the file; '' in a folder's name."""


def label_in(name: str) -> Label | None:
    """Return what Moodle or Canvas says in a name, if one of them wrote it."""
    for platform, form in (('moodle', _MOODLE), ('canvas', _CANVAS)):
        if (found := form.fullmatch(name)) and not _is_term(found.groupdict()):
            who, number = found['who'], found['number']
            who = f'{who} {number}' if who in _ANONYMOUS else who
            return Label(platform, number, who, found['rest'] or '')
    return None


def _is_term(found: Mapping[str, str]) -> bool:
    """Whether two numbers are those of a year and the next, as in ws_2026_2027_group_a."""
    number, upload = found['number'], found.get('upload', '')
    return len(number) == len(upload) == 4 and int(upload) - int(number) in (0, 1)


def student_in(name: str) -> str:
    """Return the student's name in a name. Raises Unclear."""
    name = unicodedata.normalize('NFC', name)
    if label := label_in(name):
        name = label.who
    name = name.strip(' ')
    if problem := problem_of_id(name):
        raise Unclear(problem)
    return name


def same_person(one: str, other: str) -> bool:
    """Whether two names may be one: case, accents, the words' order and what parts them apart."""
    return not spellings(one).isdisjoint(spellings(other))


@lru_cache(maxsize=10_000)
def spellings(name: str) -> frozenset[str]:
    """Return what two names that may be one have in common: their words, in any order."""
    plain = unicodedata.normalize('NFKD', name).casefold()
    words = re.findall(r'[^\W_]+', ''.join(c for c in plain if not unicodedata.combining(c)))
    if not words:
        return frozenset({name})
    orders = permutations(words) if len(words) <= MOST_WORDS else [words]
    return frozenset({' '.join(sorted(words)), *(''.join(order) for order in orders)})


def is_nobody(name: str) -> bool:
    """Whether a folder or an archive is named after work or a term, and after no student."""
    words = set(re.findall(r'[^\W\d_]+', unicodedata.normalize('NFC', name).lower()))
    return bool(words & _WORDS_OF_NOBODY) and words <= _WORDS_OF_NOBODY | _BESIDE_THEM


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
