"""Observes the callbacks of this process by repeated looks from another of its threads."""

import contextlib
import linecache
import sysconfig
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import rclpy
from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.service import Service
from rclpy.task import Future, Task

from my_robot_basics.doctor import waits
from my_robot_basics.doctor.callback import Callback
from my_robot_basics.doctor.work import (
    Work,
    callbacks_in_progress,
    own_nodes,
    spinning_executors,
    thread_stacks,
)

_NOT_THEIRS = (
    f'{Path(rclpy.__file__).parent}/',
    f'{sysconfig.get_path("stdlib")}/',
    f'{Path(__file__).parents[1] / "live"}/',
)
"""Folders of rclpy, Python's standard library and `live`: their code is not the student's."""
SURE_SEC = 1.0
"""After this long, a deadlock or a lost request is reported."""
LONG_SEC = 5.0
"""After this long, any other callback that has not returned is reported: it may be slow."""


class Inside:
    """Compares the callbacks in progress at each call of `look`, and reports which have lasted."""

    def __init__(self, service_name: str = '') -> None:
        """Observe callbacks, and requests to `service_name`, if one is given."""
        self._service_name = service_name
        self._works: dict[Task, tuple[float, Work]] = {}
        self._requests: dict[Future, tuple[float, str]] = {}
        self._spun: set[object] = set()

    def look(self) -> None:
        """Record which callbacks are in progress and which requests have no answer."""
        with contextlib.suppress(InvalidHandle):  # a node was destroyed just now
            self._look()

    def _look(self) -> None:
        now, threads = time.monotonic(), thread_stacks()
        self._spun.update(spinning_executors(threads))
        works = {}
        for work in callbacks_in_progress(threads):
            since, last = self._works.get(work.task, (now, work))
            # while a coroutine resumes, its frames can't be seen: keep the former ones
            works[work.task] = since, work if work.frames else last
        asked, self._works = dict(self._last_requests()), works
        serves = any(_service_of(w) == self._service_name for _, w in self._works.values())
        self._requests = {
            future: (now if serves else self._requests.get(future, (now, ''))[0], node_name)
            for future, node_name in asked.items()
        }

    def callbacks(self, *, at_least_sec: float) -> tuple[Callback, ...]:
        """Return the callbacks that have been in progress for `at_least_sec`, and still are."""
        now, works = time.monotonic(), [work for _, work in self._works.values()]
        found = []
        for since, work in self._works.values():
            if now - since >= at_least_sec:
                with contextlib.suppress(InvalidHandle):  # its node was destroyed just now
                    found.append(_describe(work, works, seconds=now - since))
        return tuple(found)

    def lasting(self, *, at_least_sec: float = LONG_SEC) -> tuple[Callback, ...]:
        """Return the callbacks in a deadlock, and those in progress for `at_least_sec`."""
        sure = self.callbacks(at_least_sec=SURE_SEC)
        return tuple(each for each in sure if each.is_sure() or each.seconds >= at_least_sec)

    def unanswered(self, *, at_least_sec: float) -> dict[str, float]:
        """Return, by node, how long its last request had no answer while the server was idle."""
        now = time.monotonic()
        return {
            node_name: now - since
            for since, node_name in self._requests.values()
            if now - since >= at_least_sec
        }

    def unspun(self) -> frozenset[str]:
        """Return the nodes that no thread spins."""
        return frozenset(
            node.get_fully_qualified_name()
            for node in own_nodes()
            if node.executor is None or _is_taken(node) or not self._may_spin(node)
        )

    def _may_spin(self, node: Node) -> bool:
        # no Python frame shows whether an executor written in C++ spins
        return not isinstance(node.executor, Executor) or node.executor in self._spun

    def _last_requests(self) -> Iterator[tuple[Future, str]]:
        for node in own_nodes():
            for client in node.clients:
                pending = waits.pending_requests(client)
                if pending and client.service_name == self._service_name:
                    yield pending[max(pending)], node.get_fully_qualified_name()


def observable_nodes() -> frozenset[str]:
    """Return the nodes of this process whose callbacks can be observed."""
    return frozenset(
        node.get_fully_qualified_name()
        for node in own_nodes()
        if node.executor is None or isinstance(node.executor, Executor)
    )


def nodes_taken_from_executors() -> frozenset[str]:
    """Return the nodes of this process that were removed from the executor that spun them."""
    return frozenset(node.get_fully_qualified_name() for node in own_nodes() if _is_taken(node))


def _is_taken(node: Node) -> bool:
    """Whether the node's executor lost it: the node was added to another one, and removed."""
    return node.executor is not None and node not in node.executor.get_nodes()


def _describe(work: Work, works: list[Work], *, seconds: float) -> Callback:
    theirs = [f for f in work.frames if not f.f_code.co_filename.startswith(_NOT_THEIRS)]
    waits_in, client = waits.current_wait(work.frames)
    node = work.node or (waits.node_of(client) if client else None)
    return Callback(
        node_name=node.get_fully_qualified_name() if node else '',
        name=theirs[0].f_code.co_name if theirs else '',
        line=_line(theirs[-1]) if theirs else '',
        seconds=seconds,
        service_name=_service_of(work),
        waits_in=waits_in,
        waits_for=client.service_name if client else '',
        keeps=waits.response_blocker(work, works),
        asks=waits.pending_service(work),
        holds=tuple(sorted({n.get_fully_qualified_name() for n in waits.blocked_nodes(work)})),
    )


def _service_of(work: Work) -> str:
    return work.entity.service_name if isinstance(work.entity, Service) else ''


def _line(frame: FrameType) -> str:
    line_number = frame.f_lineno
    code = linecache.getline(frame.f_code.co_filename, line_number).strip()
    return f'line {line_number}: {code}' if code else f'line {line_number}'
