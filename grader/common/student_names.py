"""Names of students, as they appear in names of files and folders."""

import re
import unicodedata
from functools import lru_cache
from itertools import permutations

from my_robot_basics.validate.text import visible

MAX_ID_CHARACTERS, MAX_ID_BYTES = 128, 200
"""How long a name may be in nbgrader's database, and in a folder's name with a suffix."""
HTML = frozenset('<>"')
"""Characters that the formgrader's tables would show unescaped, in text and in attributes."""
MOST_WORDS = 4
"""Names with at most this many words are compared in all word orders, written as one word."""

_UPLOADS = """
    notebooks submitted submissions submission inbound assignment assignments homework hw task
    tasks exercise exercises solution solutions answer answers lab labs lesson lessons project
    upload uploads download downloads files folder archive zip week term semester class course
    students abgabe abgaben aufgabe aufgaben hausaufgabe hausaufgaben übung übungen lösung
    lösungen woche kurs devoir devoirs exercice exercices travail rendu semaine tarea tareas
    ejercicio ejercicios entrega semana trabajo compito compiti esercizio esercizi 作业 作業
    copy kopie copie copia 副本
    """
_WORDS_OF_NOBODY = frozenset(_UPLOADS.split())
_BESIDE_THEM = frozenset(
    {'my', 'the', 'final', 'of', 'for', 'ros', 'jupyter', 'meine', 'mes', 'mis', 'von', 'de', 'di'}
)


class UnclearOwner(Exception):
    """Why a file can't be assigned to a student, in a sentence."""


def same_person(one: str, other: str) -> bool:
    """Whether two names may be the same, ignoring case, accents, word order and separators."""
    return not spellings(one).isdisjoint(spellings(other))


@lru_cache(maxsize=10_000)
def spellings(name: str) -> frozenset[str]:
    """Return keys to compare names by; two names that may be the same share one."""
    plain = unicodedata.normalize('NFKD', name).casefold()
    words = re.findall(r'[^\W_]+', ''.join(c for c in plain if not unicodedata.combining(c)))
    if not words:
        return frozenset({name})
    orders = permutations(words) if len(words) <= MOST_WORDS else [words]
    return frozenset({' '.join(sorted(words)), *(''.join(order) for order in orders)})


def is_nobody(name: str) -> bool:
    """Whether a folder or an archive is named after work or a term, not after a student."""
    words = set(re.findall(r'[^\W\d_]+', unicodedata.normalize('NFC', name).lower()))
    return bool(words & _WORDS_OF_NOBODY) and words <= _WORDS_OF_NOBODY | _BESIDE_THEM


def problem_of_id(student_id: str) -> str:
    """Return why a text can't be the name of a student's folder, or ''."""
    if not student_id or student_id.startswith('.'):
        return 'there is no name of a student in it'
    if visible(student_id) != student_id or any(mark in student_id for mark in '/\n\t'):
        return "the student's name holds characters that can't be shown: rename it"
    if HTML.intersection(student_id):
        return 'the student\'s name holds one of < > ": the formgrader would take it for HTML'
    if len(student_id) > MAX_ID_CHARACTERS or len(student_id.encode()) > MAX_ID_BYTES:
        return f"the student's name is too long: at most {MAX_ID_CHARACTERS} characters are kept"
    return ''
