"""Whether anything in a notebook may still create an endpoint while none of its cells runs.

A missing publisher may still be created: by a thread of the student's, by a process that was
started, by a timer's callback. If there is none of these, it is useless to wait longer, however
slow the machine is.
"""

import asyncio
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator

import psutil

_OURS = ('ipykernel', 'my_robot_basics')
"""Packages whose threads and tasks create no endpoint by themselves."""
_HISTORY = 'IPython.core.history'
"""Its thread stores the cells that have run, in each kernel of JupyterLab."""
_FIRED_SEC = 2.0
"""A timer counts as fired when its period and this much time have passed."""


def settled_nodes(lived_sec: float = 0.0) -> list[str] | None:
    """Return the full names of this process's nodes; None if another endpoint may be created.

    A timer may create one when it first fires. The nodes have existed for at least `lived_sec`:
    a timer whose period is shorter by more than _FIRED_SEC has fired.
    """
    if any(may_come() for may_come in (_has_threads, _has_processes, _has_tasks, _has_alarm)):
        return None
    if 'rclpy' not in sys.modules:
        return []
    from my_robot_basics.session.neighbours import nodes_here

    nodes = [*nodes_here()]
    most_sec = max(0.0, lived_sec - _FIRED_SEC)
    periods = [t.timer_period_ns / 1e9 for n in nodes for t in n.timers if not t.is_canceled()]
    if any(period_sec >= most_sec for period_sec in periods):
        return None
    return [n.get_fully_qualified_name() for n in nodes if not n.get_name().startswith('_')]


def _has_threads() -> bool:
    known = {thread.ident for thread in threading.enumerate() if _is_ours(thread)}
    # _current_frames also has the threads that `threading` does not know
    return bool(sys._current_frames().keys() - known)


def _is_ours(thread: threading.Thread) -> bool:
    target: Callable[[], object] | None = getattr(thread, '_target', None)
    module = type(thread).__module__ if target is None else getattr(target, '__module__', '')
    is_of_kernel = module == _HISTORY or f'{module}'.partition('.')[0] in _OURS
    return thread is threading.main_thread() or is_of_kernel or _is_idle_loop(target)


def _is_idle_loop(target: object) -> bool:
    """Whether a thread runs an event loop that has nothing to do: `%%bash` leaves one behind."""
    loop = getattr(target, '__self__', None)
    if not isinstance(loop, asyncio.BaseEventLoop):
        return False
    return not asyncio.all_tasks(loop) and not vars(loop)['_scheduled']  # it has no public name


def _has_processes() -> bool:
    """Whether processes that were started here still run, also after their parents ended."""
    return bool(psutil.Process().children(recursive=True)) or any(_session_pids())


def _session_pids() -> Iterator[int]:
    ours = os.getsid(0)
    for pid in psutil.pids():
        try:
            if pid != os.getpid() and os.getsid(pid) == ours:
                yield pid
        except (ProcessLookupError, PermissionError):
            continue


def _has_tasks() -> bool:
    try:
        tasks = asyncio.all_tasks()
    except RuntimeError:  # no event loop runs here
        return False
    return any(_module_of(task).partition('.')[0] not in _OURS for task in tasks)


def _module_of(task: asyncio.Task) -> str:
    frame = getattr(task.get_coro(), 'cr_frame', None)
    return str(frame.f_globals.get('__name__', '')) if frame else ''


def _has_alarm() -> bool:
    return any(signal.getitimer(which)[0] for which in (signal.ITIMER_REAL, signal.ITIMER_PROF))
