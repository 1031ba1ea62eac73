"""What the callbacks of this process do, looked at again and again from another thread of it."""

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
from my_robot_basics.doctor.work import Work, in_progress, own_nodes, spinning, stacks

_NOT_THEIRS = (
    f'{Path(rclpy.__file__).parent}/',
    f'{sysconfig.get_path("stdlib")}/',
    f'{Path(__file__).parents[1] / "live"}/',
)
"""What rclpy, Python's own library and `live` do in there is no line of the student's."""
SURE_SEC = 1.0
"""So long a callback has to wait, that can't get what it waits for, or a request be lost."""
LONG_SEC = 5.0
"""So long any other callback has to go on: it may be slow."""


class Inside:
    """Looks at this process, whenever `look` is called, and tells what lasted."""

    def __init__(self, service_name: str = '') -> None:
        """`service_name`: the service whose requests are of interest, if any."""
        self._service_name = service_name
        self._works: dict[Task, tuple[float, Work]] = {}
        self._requests: dict[Future, tuple[float, str]] = {}
        self._spun: set[object] = set()

    def look(self) -> None:
        """Look once."""
        with contextlib.suppress(InvalidHandle):  # a node was destroyed just now
            self._look()

    def _look(self) -> None:
        now, threads = time.monotonic(), stacks()
        self._spun.update(spinning(threads))
        works = {}
        for work in in_progress(threads):
            since, last = self._works.get(work.task, (now, work))
            # in the moment in which a coroutine goes on nobody sees where it is
            works[work.task] = since, work if work.frames else last
        asked, self._works = dict(self._last_requests()), works
        serves = any(_service_of(w) == self._service_name for _, w in self._works.values())
        self._requests = {
            future: (now if serves else self._requests.get(future, (now, ''))[0], node_name)
            for future, node_name in asked.items()
        }

    def callbacks(self, *, at_least_sec: float) -> tuple[Callback, ...]:
        """The callbacks that have been in progress for so long, and still are."""
        now, works = time.monotonic(), [work for _, work in self._works.values()]
        found = []
        for since, work in self._works.values():
            if now - since >= at_least_sec:
                with contextlib.suppress(InvalidHandle):  # its node was destroyed just now
                    found.append(_describe(work, works, seconds=now - since))
        return tuple(found)

    def lasting(self, *, at_least_sec: float = LONG_SEC) -> tuple[Callback, ...]:
        """The callbacks that can't get what they wait for, or go on for so long."""
        sure = self.callbacks(at_least_sec=SURE_SEC)
        return tuple(each for each in sure if each.is_sure() or each.seconds >= at_least_sec)

    def unanswered(self, *, at_least_sec: float) -> dict[str, float]:
        """How long the last request of a node had no answer, while none was being answered."""
        now = time.monotonic()
        return {
            node_name: now - since
            for since, node_name in self._requests.values()
            if now - since >= at_least_sec
        }

    def unspun(self) -> frozenset[str]:
        """The nodes that no thread spins."""
        return frozenset(
            node.get_fully_qualified_name()
            for node in own_nodes()
            if node.executor is None or _is_taken(node) or not self._may_spin(node)
        )

    def _may_spin(self, node: Node) -> bool:
        # of executors in C++, no thread shows whether they spin
        return not isinstance(node.executor, Executor) or node.executor in self._spun

    def _last_requests(self) -> Iterator[tuple[Future, str]]:
        for node in own_nodes():
            for client in node.clients:
                pending = waits.pending(client)
                if pending and client.service_name == self._service_name:
                    yield pending[max(pending)], node.get_fully_qualified_name()


def visible() -> frozenset[str]:
    """The nodes of this process whose callbacks can be looked at."""
    return frozenset(
        node.get_fully_qualified_name()
        for node in own_nodes()
        if node.executor is None or isinstance(node.executor, Executor)
    )


def taken() -> frozenset[str]:
    """The nodes of this process that were taken from the executor that spun them."""
    return frozenset(node.get_fully_qualified_name() for node in own_nodes() if _is_taken(node))


def _is_taken(node: Node) -> bool:
    """Whether the node's executor has it no more: it was added to another one, and removed."""
    return node.executor is not None and node not in node.executor.get_nodes()


def _describe(work: Work, works: list[Work], *, seconds: float) -> Callback:
    theirs = [f for f in work.frames if not f.f_code.co_filename.startswith(_NOT_THEIRS)]
    waits_in, client = waits.waits(work.frames)
    node = work.node or (waits.node_of(client) if client else None)
    return Callback(
        node_name=node.get_fully_qualified_name() if node else '',
        name=theirs[0].f_code.co_name if theirs else '',
        line=_line(theirs[-1]) if theirs else '',
        seconds=seconds,
        service_name=_service_of(work),
        waits_in=waits_in,
        waits_for=client.service_name if client else '',
        keeps=waits.keeps(work, works),
        asks=waits.asks(work),
        holds=tuple(sorted({n.get_fully_qualified_name() for n in waits.held(work)})),
    )


def _service_of(work: Work) -> str:
    return work.entity.service_name if isinstance(work.entity, Service) else ''


def _line(frame: FrameType) -> str:
    text = linecache.getline(frame.f_code.co_filename, frame.f_lineno).strip()
    return f'line {frame.f_lineno}: {text}' if text else f'line {frame.f_lineno}'
