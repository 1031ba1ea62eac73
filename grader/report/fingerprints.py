"""Find answers that are alike, apart from names, strings, comments and layout.

It reads texts of students, so it runs in a process with limits. `copydetect` compares them by
winnowing, as MOSS compares programs: here, all groups of GROUP_CHARACTERS characters.
"""

import io
from collections import Counter, defaultdict
from collections.abc import Container
from itertools import combinations

from copydetect import CodeFingerprint, compare_files
from copydetect.utils import highlight_overlap

GROUP_CHARACTERS = 20
"""Characters in a group, where each name counts as one character: about one short statement."""
FEWEST_GROUPS = 60
"""If two answers share fewer rare groups than this, they only have in common what is usual."""
LEAST_SHARE = 0.7
"""The share of the shorter answer's rare groups that the other must have, too."""
COMMON_SHARE, COMMON_STUDENTS = 0.1, 3
"""A group that more of the class than this share, and more students than this, wrote is common."""


def find_pairs(answers: dict[str, str], released: str, most: int) -> list[dict]:
    """Return the pairs of students whose answers are most alike, the most similar first.

    Each has `students`, two names; `share`, from 0 to 1; and `texts`, both answers as HTML with
    <mark> around what they have in common. Groups of the released text do not count.
    """
    prints = {student: _fingerprint(code) for student, code in answers.items()}
    given = _fingerprint(released).hashes
    who = defaultdict(set)
    for student, found in prints.items():
        for group in found.hashes - given:
            who[group].add(student)
    limit = max(COMMON_STUDENTS, COMMON_SHARE * len(answers))
    rare = {group: students for group, students in who.items() if len(students) <= limit}
    for found in prints.values():
        _keep(found, rare)
    own = Counter(student for students in rare.values() for student in students)
    both = Counter(
        pair for students in rare.values() for pair in combinations(sorted(students), 2)
    )
    alike = [
        (shared / min(own[one], own[other]), one, other)
        for (one, other), shared in both.items()
        if shared >= FEWEST_GROUPS
    ]
    alike.sort(key=lambda each: (-each[0], each[1:]))
    return [
        {
            'students': [one, other],
            'share': share,
            'texts': _marked(prints[one], prints[other]),
        }
        for share, one, other in alike[:most]
        if share >= LEAST_SHARE
    ]


def _fingerprint(code: str) -> CodeFingerprint:
    """Return all groups of a text: with a window of 1, winnowing leaves none out."""
    return CodeFingerprint(
        'answer.py', GROUP_CHARACTERS, 1, language='python', fp=io.StringIO(code)
    )


def _marked(one: CodeFingerprint, other: CodeFingerprint) -> list[str]:
    """Return both texts as HTML, with marks around what they have in common."""
    _, _, places = compare_files(one, other)
    return [
        highlight_overlap(
            text.raw_code,
            at.clip(0, len(text.raw_code)).astype(int),
            '<mark>',
            '</mark>',
            escape_html=True,
        )[0]
        for text, at in zip((one, other), places, strict=True)
    ]


def _keep(found: CodeFingerprint, groups: Container[int]) -> None:
    """Remove all groups of a fingerprint except these."""
    found.hash_idx = {group: at for group, at in found.hash_idx.items() if group in groups}
    found.hashes = set(found.hash_idx)
