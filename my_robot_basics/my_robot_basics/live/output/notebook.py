"""Show outputs in a notebook's cells; outside a notebook kernel, on stdout."""

import itertools
import threading
import time
from collections.abc import Callable

import rclpy.logging

from my_robot_basics.drawing.described import Bundle, png_output
from my_robot_basics.language.speaking import language_here
from my_robot_basics.live.output.log_lines import CONSOLE_FORMAT, LogRecord
from my_robot_basics.live.output.stdout_tap import StdoutTap
from my_robot_basics.session import kernel
from my_robot_basics.session.environment import set_meanwhile

PAUSE_SEC = 0.25
"""Pause between two updates, so that a flood of messages does not become a flood of displays."""

_tap: StdoutTap | None = None
_numbers = itertools.count()


def in_kernel() -> bool:
    """Whether this process is a notebook's kernel."""
    return kernel.shell() is not None


def open_tap() -> None:
    """Start reading the ROS logger's output, in a notebook kernel."""
    global _tap
    if _tap is None and in_kernel():
        _tap = StdoutTap()
        _mark_log_records()
        # else a large picture that is sent at the kernel's end uses a part of ZMQ that is gone
        kernel.shell().kernel.iopub_thread.socket.copy_threshold = 2**31 - 1


def _mark_log_records() -> None:
    """Set up the ROS logger with RECORD_END after each record, unless it is set up already."""
    # only meanwhile: programs that the notebook starts must log in the normal format
    with set_meanwhile('RCUTILS_CONSOLE_OUTPUT_FORMAT', CONSOLE_FORMAT):
        rclpy.logging.initialize()


def leave() -> None:
    """Stop updating displays, and restore stdout."""
    global _tap
    _refresher.stop()
    if _tap is not None:
        _tap.close()
        _tap = None


def listen(logger: str, sink: Callable[[LogRecord], None]) -> None:
    """Pass the records of the logger with that name to `sink`."""
    if _tap is not None:
        _tap.give(logger, sink)


def listen_no_more(sink: Callable[[LogRecord], None]) -> None:
    """Stop passing records to `sink`."""
    if _tap is not None:
        _tap.take_back(sink)


def sync() -> None:
    """Return when every log line written so far has reached its sink."""
    if _tap is not None:
        _tap.sync()


class Display:
    """One output of the cell that runs now, updated in place from any thread."""

    def __init__(self) -> None:
        """Store the current cell; nothing appears before `show`."""
        self._shell = kernel.shell()
        self._cell = self._shell.get_parent() if self._shell else None
        self._id = f'live-{next(_numbers)}-{time.time_ns():x}'
        self._shown = False

    def adopt_thread(self) -> None:
        """Make the outputs of this thread appear with the cell."""
        if self._shell:
            self._shell.set_thread_parent(self._cell)

    def show(self, bundle: Bundle) -> None:
        """Publish the output for the first time."""
        if self._shell:
            self._publish(bundle, update=False)
            self._shown = True
        elif 'image/png' in bundle:
            print(bundle['text/plain'])

    def update_soon(self, render: Callable[[], Bundle]) -> None:
        """Publish the result of `render()` in the next round of updates."""
        if self._shown:
            _refresher.add(self, render)

    def update(self, bundle: Bundle) -> None:
        """Update the output at once, in its own cell, whichever cell runs."""
        if not self._shown or _refresher.stopped:
            return
        publisher = self._shell.display_pub
        token = publisher.set_thread_parent(self._cell)
        try:
            self._publish(bundle, update=True)
        finally:
            publisher.reset_thread_parent(token)

    def _publish(self, bundle: Bundle, *, update: bool) -> None:
        metadata = None
        if 'image/png' in bundle:
            bundle, metadata = png_output(
                bundle['image/png'], bundle['text/plain'], language_here()
            )
        self._shell.display_pub.publish(
            bundle, metadata=metadata, transient={'display_id': self._id}, update=update
        )


def show_picture(png: bytes, text: str) -> None:
    """Show a picture with its alternative text in the cell that runs now."""
    Display().show({'image/png': png, 'text/plain': text})


class _Refresher:
    """The thread that updates displays, a few times a second."""

    def __init__(self) -> None:
        self._due: dict[Display, Callable[[], Bundle]] = {}
        self._wanted = threading.Event()
        self.stopped = False
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()

    def add(self, display: Display, render: Callable[[], Bundle]) -> None:
        with self._lock:
            if self.stopped:
                return
            self._due[display] = render
            if self._thread is None:
                self._thread = threading.Thread(target=self._refresh, daemon=True)
                self._thread.start()
        self._wanted.set()

    def stop(self) -> None:
        with self._lock:
            self.stopped = True
        self._wanted.set()

    def _refresh(self) -> None:
        while not self.stopped:
            self._wanted.wait()
            self._wanted.clear()
            with self._lock:
                due, self._due = self._due, {}
            for display, render in due.items():
                display.update(render())
            time.sleep(PAUSE_SEC)


_refresher = _Refresher()
