"""Nodes in the background of a notebook kernel: `run` starts or replaces one, `stop` ends it."""

import atexit
import os
import threading
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from my_robot_basics.live.nodes import answer_end, slow_start, spinning
from my_robot_basics.live.nodes.background import Background
from my_robot_basics.live.nodes.destroying import destroy
from my_robot_basics.live.nodes.naming import announce_name
from my_robot_basics.live.nodes.refusals import (
    expect_runnable,
    has_overwritten,
    is_made,
    no_node_yet,
)
from my_robot_basics.live.output import notebook
from my_robot_basics.live.output.overwritten import spoils_rclpy
from my_robot_basics.live.output.panel import STOPPED, NodePanel, Panel
from my_robot_basics.live.packages import commands, executables, node_file
from my_robot_basics.live.patches import interrupting, rclpy_patches
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable, tell
from my_robot_basics.session.neighbours import Neighbours, destroy_orphans

N = TypeVar('N', bound=Node)

_running: dict[str, Background] = {}
_panels: dict[str, NodePanel] = {}
_neighbours = Neighbours()
_lock = threading.RLock()
_is_set_up = False


class _NotStartedByLive(Exception):
    """A node of that name exists already, and `live` has not started it."""


def run(NodeClass: type[N], *args: Any, key: str | None = None, **kwargs: Any) -> N | None:
    """Create `NodeClass(*args, **kwargs)` and spin it in the background; return the node.

    It replaces the node that runs under `key` (by default the class's name), and any other node
    of `live` with its node name. rclpy is initialised if needed. If a node of that name already
    runs outside `live`, no second one is started: this is printed, and the result is None. An
    exception of the constructor is raised; the former node is stopped all the same.
    """
    __tracebackhide__ = True
    expect_runnable(NodeClass)
    key = NodeClass.__name__ if key is None else key
    return launch(NodeClass, args, kwargs, key=key, make_panel=lambda: Panel(NodeClass.__name__))


def launch(
    NodeClass: type[N],
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
    *,
    key: str,
    make_panel: Callable[[], NodePanel],
) -> N | None:
    """Do the same as `run` with another panel, which is created after stdout is redirected."""
    __tracebackhide__ = True
    _stop_keys([key, *(k for k, background in _running.items() if not background.alive)])
    answer_end.note_restart(key)
    ensure_rclpy()
    panel = make_panel()

    def on_name(name: str) -> None:
        same = [k for k, b in _running.items() if b.name == name]
        _stop_keys(answer_end.note_end(same, (key, name)))
        if _neighbours.has_node(name):
            raise _NotStartedByLive(name)
        panel.listen(name)

    node = NodeClass.__new__(NodeClass, *args, **kwargs)
    try:
        with announce_name(node, on_name), slow_start.told(NodeClass.__name__):
            returned = type(node).__init__(node, *args, **kwargs)
        if returned is not None:  # as Python requires when it calls __init__ itself
            raise TypeError(f"__init__() should return None, not '{type(returned).__name__}'")
        if not is_made(node):
            raise NotRunnable(no_node_yet(NodeClass))
    except _NotStartedByLive as found:
        tell(
            f'a node named {found} already runs outside live: no second one was started. '
            'Stop that one first, or give yours another name.'
        )
        return None
    except BaseException as error:
        too_soon = isinstance(error, AttributeError) and error.obj is node and not is_made(node)
        attribute = spoils_rclpy(node, error) if is_made(node) else ''
        if is_made(node):
            destroy(node)  # else the publishers that it has created would stay on the graph
        panel.show('its constructor failed')
        panel.close('its constructor failed')
        if too_soon:
            raise NotRunnable(no_node_yet(NodeClass)) from None
        if attribute:
            raise NotRunnable(has_overwritten(NodeClass, attribute)) from error
        raise
    panel.show('running')
    with _lock:
        _panels[key] = panel
        _running[key] = Background(
            node, on_error=panel.error, on_end=panel.close, before=panel.adopt_thread
        )
    return node


def stop(key_or_node: str | type[Node] | Node | None = None) -> None:
    """Stop the node with this key or full name, this node, or this class's; by default, all nodes.

    "All" includes processes that `run_commands` and `run_executable` have started; for the
    latter, it is printed how each has ended.
    """
    if key_or_node is None:
        _stop_keys(answer_end.note_end(_running))
        commands.stop_commands()
        executables.stop_started()
        return
    keys = [k for k, b in _running.items() if key_or_node in (k, b.name, b.node, type(b.node))]
    if not keys:
        name = getattr(key_or_node, '__name__', repr(key_or_node))
        tell(f'nothing to stop: no node runs as {name}')
    _stop_keys(answer_end.note_end(keys))


def _stop_keys(keys: list[str]) -> None:
    for key in keys:
        with _lock:
            background, panel = _running.pop(key, None), _panels.pop(key, None)
        if background is not None:
            background.stop()
        if panel is not None:
            panel.close(STOPPED)


def ensure_rclpy() -> None:
    """Initialise rclpy in the lesson's domain, if it is not; print a note if it is in another."""
    domain_of_lesson = set_up()
    # rclpy.init() in a student's cell handles Ctrl-C: then a thread of rclpy shuts down every
    # context of this process, on a busy machine possibly after the next node has started
    uninstall_signal_handlers()
    destroy_orphans()
    if not rclpy.ok():
        rclpy.try_shutdown()  # a context that was shut down by hand cannot be initialised again
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        interrupting.forget_dead_executor()
    domain_id = rclpy.get_default_context().get_domain_id()
    if domain_id != domain_of_lesson:
        tell(
            f'note: rclpy was initialised in ROS domain {domain_id}, and this lesson is in '
            f'{domain_of_lesson}: call rclpy.shutdown(), then run this cell again'
        )
    _neighbours.start()


def shut_down() -> None:
    """Stop every node, then shut rclpy's default context down, whichever code initialised it."""
    stop()
    rclpy.try_shutdown()


def set_up() -> int:
    """Set this process up for a lesson, once, and return its ROS domain ID.

    A notebook's kernel reads the ROS log from then on, has %%write_node, and can interrupt a cell
    that spins. Nodes of `run` are stopped when Python ends. Raises NoFreeDomain or BadDomain.
    """
    global _is_set_up
    domain_id = classroom.enter()
    notebook.open_tap()
    if not _is_set_up:
        _is_set_up = True
        if notebook.in_kernel():
            node_file.register()
            interrupting.let_cells_be_interrupted()
            if not classroom.in_grading_room():
                spinning.help_in_cells()
        rclpy_patches.patch_rclpy()
        atexit.register(_leave_nothing, os.getpid())
    return domain_id


def _leave_nothing(owner_pid: int) -> None:
    # not in a forked child, which has neither these threads nor these DDS participants
    if os.getpid() == owner_pid:
        shut_down()
        _neighbours.stop()
        notebook.leave()
