"""A grade cell in a test's room, for tests: its checks share what they found out."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from my_robot_basics.graph import cell_context


@contextmanager
def grade_cell(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], object]]:
    """Yield a function that ends the running cell, after which the next one begins."""
    ends: list[Callable[[], object]] = []
    shell = SimpleNamespace(events=SimpleNamespace(register=lambda _, end: ends.append(end)))
    monkeypatch.setattr(cell_context, 'kernel', SimpleNamespace(shell=lambda: shell))
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    # there is no grader to pass requests on
    monkeypatch.setattr('my_robot_basics.exchange.asking.is_in_test_room', lambda: False)
    try:
        yield lambda: [end() for end in ends]
    finally:
        for end in ends:
            end()
