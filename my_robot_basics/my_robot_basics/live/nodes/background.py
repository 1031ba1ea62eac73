"""One node, one executor, one thread: so a node can be replaced and leaves nothing behind."""

import threading
from collections.abc import Callable

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from my_robot_basics.live.nodes.destroying import destroy

JOIN_TIMEOUT_SEC = 1.0
"""How long `stop` waits for a running callback before it destroys the node all the same."""


class Background:
    """A node that spins in a daemon thread until `stop()`, or until its context is shut down."""

    def __init__(
        self,
        node: Node,
        *,
        on_error: Callable[[BaseException], None],
        on_end: Callable[[str], None],
        before: Callable[[], None] = lambda: None,
    ) -> None:
        """Start spinning.

        `on_error` gets each exception that a callback raises; `on_end` gets the reason when
        the node ends by itself; `before` is called first. All three run in the node's thread.
        """
        self.node = node
        self.name = node.get_fully_qualified_name()
        self._on_error = on_error
        self._on_end = on_end
        self._before = before
        self._stopping = threading.Event()
        self._lock = threading.Lock()
        self._destroyed = False
        self._executor = SingleThreadedExecutor(context=node.context)
        if node.executor is None:  # else its constructor has added it to an executor
            self._executor.add_node(node)
        self._thread = threading.Thread(
            target=self._spin, name=f'spin {node.get_name()}', daemon=True
        )
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Whether the node still spins."""
        return self._thread.is_alive()

    def stop(self) -> None:
        """Stop spinning, wait for the callback that runs, and destroy the node."""
        self._stopping.set()
        with self._lock:
            if not self._destroyed:
                self._executor.create_task(lambda: None)  # wake() alone does not end a wait
        if threading.current_thread() is self._thread:
            return  # a callback stops its own node: the thread ends after this callback
        self._thread.join(JOIN_TIMEOUT_SEC)
        if self._thread.is_alive():
            # the callback does not return: once the node is destroyed, its next use of it raises
            self._destroy()
            self._thread.join(JOIN_TIMEOUT_SEC)

    def _spin(self) -> None:
        self._before()
        try:
            while not self._stopping.is_set():
                if not self.node.context.ok():
                    self._on_end('rclpy was shut down')
                    break
                self._spin_once()
        finally:
            self._destroy()

    def _spin_once(self) -> None:
        try:
            self._executor.spin_once(timeout_sec=1.0)
        except ExternalShutdownException:
            pass  # the loop in _spin checks the context
        except SystemExit:
            self._stopping.set()
            self._on_end('a callback called exit()')
        except BaseException as error:
            if not self._stopping.is_set():
                self._on_error(error)

    def _destroy(self) -> None:
        with self._lock:
            if self._destroyed:
                return
            self._destroyed = True
        executor = self.node.executor
        if executor is not None:
            executor.remove_node(self.node)
        destroy(self.node)
        self._executor.shutdown()
