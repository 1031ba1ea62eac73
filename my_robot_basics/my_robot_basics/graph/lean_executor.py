"""A single-threaded executor for the nodes of a check; a callback takes half of rclpy's time.

rclpy's own executor builds a new wait set for each callback, and waits once more after it. Here
the wait set is kept until a node creates or destroys an entity, and all entities that are ready
after one wait are handled.
"""

import threading
from collections.abc import Callable, Coroutine, Iterator
from typing import Any, NamedTuple

from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.task import Task
from rclpy.waitable import NumberOfEntities

KINDS = {
    'timer': 'timers',
    'subscription': 'subscriptions',
    'guard_condition': 'guards',
    'client': 'clients',
    'service': 'services',
}
"""The names of entity kinds in a wait set and in a node, in the order of rclpy's executors."""
NUMBERS = NumberOfEntities.__slots__
"""The fields with the number of each kind, in the order of the arguments of `WaitSet`."""
Take = Callable[[Any], Callable[[], Coroutine] | None]
"""Takes the message or event of an entity, and returns what handles it, if anything must."""


class _Kind(NamedTuple):
    name: str
    take: Take
    add: Callable[[Any], int]
    handles: list[Any]
    entities: dict[int, Any]
    """The entities with callbacks, by the pointer with which a wait set names them."""


class LeanExecutor(Executor):
    """Calls callbacks in the thread that calls `spin_once`, in the order of rclpy's own executor.

    Callback groups are asked only when the wait set is built (see `IgnoredCallbackGroup`), not
    before each callback: no callback of a check has to wait for another one.
    """

    def __init__(self, *, context: Context) -> None:
        """Create the executor without nodes."""
        self._is_stale = True
        self._spins_in: int | None = None
        self._wait_set: Any = None
        self._kinds: list[_Kind] = []
        self._waitables: list[Any] = []
        super().__init__(context=context)

    def wake(self) -> None:
        """End the wait: nodes call this when they create or destroy an entity."""
        self._is_stale = True
        super().wake()

    def add_node(self, node: Node) -> bool:
        """Add a node; return whether it is new."""
        self._is_stale = True
        return super().add_node(node)

    def remove_node(self, node: Node) -> None:
        """Remove a node: its callbacks are not called any more."""
        self._is_stale = True
        super().remove_node(node)

    def create_task(self, callback: Callable | Coroutine, *args: Any, **kwargs: Any) -> Task:
        """Let the next `spin_once` run a callback or coroutine; return its future."""
        task = Task(callback, args, kwargs, executor=self)
        self._keep(task)
        if self._spins_in != threading.get_ident():
            self._guard.trigger()
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Call no callback any more; return True, as no callback runs in another thread."""
        self._forget()
        return super().shutdown(timeout_sec)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait until entities are ready (None: without limit), and call their callbacks.

        Raises what the callbacks raise, and ExternalShutdownException if the context has ended.
        """
        if self._is_shutdown:
            return
        self._spins_in = threading.get_ident()
        try:
            if not self._run_tasks():
                for take, entity in self._wait(timeout_sec):
                    self._run(take, entity)
        finally:
            self._spins_in = None

    def _wait(self, timeout_sec: float | None) -> list[tuple[Take, Any]]:
        """Wait, and return all ready entities before any callback can change them."""
        if self._is_stale:
            self._gather()
        wait_set = self._wait_set
        wait_set.clear_entities()
        for kind in self._kinds:
            for handle in kind.handles:
                kind.add(handle)
        for waitable in self._waitables:
            waitable.add_to_wait_set(wait_set)
        wait_set.wait(-1 if timeout_sec is None else max(0, int(timeout_sec * 1e9)))
        found: list[tuple[Take, Any]] = [
            (self._take_waitable, waitable)
            for waitable in self._waitables
            if waitable.is_ready(wait_set)
        ]
        for kind in self._kinds:
            if kind.entities:
                ready = map(kind.entities.get, wait_set.get_ready_entities(kind.name))
                found += [(kind.take, entity) for entity in ready if entity is not None]
        return found

    def _run(self, take: Take, entity: Any) -> None:
        try:
            begin = take(entity)
        except InvalidHandle:  # an earlier callback has destroyed the entity
            return
        if begin is not None:
            coroutine = begin()
            try:
                coroutine.send(None)
            except StopIteration:
                return
            self._keep(Task(coroutine, executor=self))  # a coroutine that awaits something

    def _run_tasks(self) -> bool:
        """Continue each task once; return whether any is done. Raises what a task has raised."""
        tasks = [task for task, _, _ in self._tasks]
        for task in tasks:
            task()
        done = [task for task in tasks if task.done() or task.cancelled()]
        if done:
            with self._tasks_lock:
                self._tasks = [each for each in self._tasks if each[0] not in done]
        for task in done:
            task.result()
        return bool(done)

    def _keep(self, task: Task) -> None:
        with self._tasks_lock:
            self._tasks.append((task, None, None))

    def _take_timer(self, timer: Any) -> Callable[[], Coroutine] | None:
        with timer.handle:
            is_due = timer.handle.is_timer_ready()  # a wait set also reports canceled timers
        return super()._take_timer(timer) if is_due else None

    def _forget(self) -> None:
        self._kinds, self._waitables = [], []
        if self._wait_set is not None:
            self._wait_set.destroy_when_not_in_use()
            self._wait_set = None

    def _gather(self) -> None:
        """Build the wait set again from all entities that the nodes have now."""
        self._forget()
        self._is_stale = False
        if not self._context.ok():
            raise ExternalShutdownException
        found = {name: list(self._awaited(of_node)) for name, of_node in KINDS.items()}
        self._waitables = list(self._awaited('waitables'))
        count = NumberOfEntities(
            len(found['subscription']),
            len(found['guard_condition']) + 2,  # two are the executor's own
            *(len(found[name]) for name in ('timer', 'client', 'service')),
        )
        for waitable in self._waitables:
            count += waitable.get_num_entities()
        numbers = [getattr(count, name) for name in NUMBERS]
        self._wait_set = _rclpy.WaitSet(*numbers, self._context.handle)
        for name, entities in found.items():
            handles = [entity.handle for entity in entities]
            by_pointer = {h.pointer: each for h, each in zip(handles, entities, strict=True)}
            if name == 'guard_condition':
                handles += [self._guard.handle, self._sigint_gc.handle]
            take, add = getattr(self, f'_take_{name}'), getattr(self._wait_set, f'add_{name}')
            self._kinds.append(_Kind(name, take, add, handles, by_pointer))

    def _awaited(self, of_node: str) -> Iterator[Any]:
        """The nodes' entities of a kind, without those that their callback group excludes."""
        for node in self.get_nodes():
            for entity in getattr(node, of_node):
                if entity.callback_group is None or entity.callback_group.can_execute(entity):
                    yield entity
