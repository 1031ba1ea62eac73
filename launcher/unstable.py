"""Tests that fail beside others but pass alone: find and record them, with their reasons."""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

MOST = 2
"""How many causes of such tests a run may have."""
NO_KERNEL = 'failed on setup with "RuntimeError: Kernel died before'
"""Beginning of the reason of each cell in a lesson whose kernel did not start."""
BAD = ('failure', 'error')
UNREAD = 'collection failure'
"""pytest's message if a file of tests could not be imported."""


def read_failures(report: Path) -> dict[str, str]:
    """Return failed tests and their reasons, in one line each, from pytest's JUnit report."""
    failures: dict[str, str] = {}
    for name, case in _cases(report):
        for bad in case.iter():
            if bad.tag not in BAD:
                continue
            failures.setdefault(
                name, ' '.join(bad.get('message', '').split()) or 'no reason given'
            )
    return failures


def read_import_errors(report: Path) -> dict[str, str]:
    """Return files of tests that pytest could not import, and the last line of each error."""
    errors: dict[str, str] = {}
    for name, case in _cases(report):
        error = case.find('error')
        if error is not None and error.get('message') == UNREAD:
            why = (error.text or '').rstrip().rpartition('\n')[2]
            module = name.removeprefix('::')
            errors[f'{module.replace(".", "/")}.py'] = why.removeprefix('E').strip()
    return errors


def read_passes(report: Path) -> set[str]:
    """Return the tests that passed."""
    cases = list(_cases(report))
    return {name for name, _ in cases} - {
        name
        for name, case in cases
        if any(case.find(tag) is not None for tag in (*BAD, 'skipped'))
    }


def unstable(failures: dict[str, str], passes: set[str]) -> dict[str, str]:
    """Return the tests that failed first and passed alone, with the reasons of the failures."""
    return {name: why for name, why in failures.items() if name in passes}


def count_causes(tests: dict[str, str]) -> int:
    """Count causes: a kernel that did not start is one, though all cells of its lesson fail."""
    no_kernel = {name for name, why in tests.items() if why.startswith(NO_KERNEL)}
    return len(tests.keys() - no_kernel) + len({name.rpartition('::')[0] for name in no_kernel})


def add_unstable(record: Path, tests: dict[str, str]) -> int:
    """Append a line for each test to the record; return how many lines it has."""
    now = datetime.now().astimezone().isoformat(' ', 'minutes')
    with record.open('a', encoding='utf-8') as file:
        file.writelines(f'{now}  {name}: {why}\n' for name, why in tests.items())
    return len(record.read_text(encoding='utf-8').splitlines())


def _cases(report: Path) -> Iterator[tuple[str, ElementTree.Element]]:
    """Yield each test's name and its element; nothing if pytest wrote no report."""
    if report.is_file():
        for case in ElementTree.parse(report).iter('testcase'):
            yield f'{case.get("classname")}::{case.get("name")}', case
