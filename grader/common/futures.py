"""Futures of concurrent.futures: chain one to another, run many and yield them in order."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future
from typing import TypeVar

Item = TypeVar('Item')
Value = TypeVar('Value')
Result = TypeVar('Result')


def completed_future(value: Value) -> 'Future[Value]':
    """Return a future that already has its value."""
    future: Future[Value] = Future()
    future.set_result(value)
    return future


def then(work: 'Future[Value]', function: Callable[[Value], Result]) -> 'Future[Result]':
    """Return the future of `function(value)`, called when `work` has its value."""
    after: Future[Result] = Future()

    def settle(done: 'Future[Value]') -> None:
        try:
            after.set_result(function(done.result()))
        except BaseException as error:
            after.set_exception(error)

    work.add_done_callback(settle)
    return after


def run_ahead(
    items: Iterable[Item], start: Callable[[Item], 'Future[Result]'], *, at_most: int
) -> Iterator[tuple[Item, 'Future[Result]']]:
    """Start work on items, at most `at_most` not yet yielded; yield items in their order.

    If `start` raises, the item's future raises the same.
    """
    under_way: deque[tuple[Item, Future[Result]]] = deque()
    for item in items:
        under_way.append((item, started(start, item)))
        while under_way and (len(under_way) >= at_most or under_way[0][1].done()):
            yield under_way.popleft()
    while under_way:
        yield under_way.popleft()


def started(start: Callable[[Item], 'Future[Result]'], item: Item) -> 'Future[Result]':
    """Return `start(item)`; if it raises, a future that raises the same."""
    try:
        return start(item)
    except Exception as error:
        failed: Future[Result] = Future()
        failed.set_exception(error)
        return failed
