"""A cell's panel: the log lines and exceptions of the node that the cell has started."""

import html
import threading
from collections import deque
from dataclasses import dataclass
from typing import Protocol

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.output import notebook, troubles
from my_robot_basics.live.output.log_lines import LogRecord
from my_robot_basics.live.output.troubles import where_and_what

LINES = 12
LONGEST = 400
"""Characters of an entry that are shown."""
TO_SHOW: tuple[str, ...] = ('running', 'stopped')
STOPPED = TO_SHOW[-1]
"""The state of a node that was stopped or replaced."""
STYLE = 'margin:0;padding-left:8px;border-left:3px solid #0072b2;font-size:13px;word-break:normal'
"""Text size of other outputs, lines broken between words: not JupyterLab's default for <pre>."""


@dataclass
class PanelEntry:
    """A log record or an exception; `times` counts how often the exception occurred."""

    text: str
    where: str | None = None
    times: int = 1

    def __str__(self) -> str:
        """Return the text that the panel shows."""
        text = self.text if len(self.text) <= LONGEST else self.text[:LONGEST] + ' …'
        again = self.times - 1
        more = in_language_here(f'… {again} more time{"s"[: again != 1]}')
        return text + (f'\n  {more}' if again else '')


class NodePanel(Protocol):
    """The interface of an output about one node: its log, or a picture."""

    def listen(self, name: str) -> None:
        """Show the log lines of the node of that fully qualified name."""

    def adopt_thread(self) -> None:
        """Make this thread's output appear here."""

    def show(self, state: str) -> None:
        """Appear for the first time."""

    def error(self, error: BaseException) -> None:
        """Show an exception that a callback raised."""

    def close(self, reason: str) -> None:
        """Show why the node has ended."""


class Panel:
    """The log of one node, shown with the cell that started it and updated in place."""

    def __init__(self, title: str) -> None:
        """Make an empty panel that belongs to the cell that runs now."""
        self._title = title
        self._name = ''
        self._state = 'starting'
        self._entries: deque[PanelEntry] = deque()
        self._left_out = 0
        self._lock = threading.Lock()
        self._display = notebook.Display()

    def listen(self, name: str) -> None:
        """Show the log lines of the node of that fully qualified name."""
        self._name = name
        troubles.forget(name)
        notebook.listen(name.strip('/').replace('/', '.'), self.log)

    def adopt_thread(self) -> None:
        """Make this thread's output appear with the panel's cell."""
        self._display.adopt_thread()

    def show(self, state: str) -> None:
        """Publish the panel for the first time, with all entries so far."""
        notebook.sync()
        with self._lock:
            self._state = state
        self._display.show(self._bundle())

    def log(self, record: LogRecord) -> None:
        """Add a log record."""
        self._add(PanelEntry(f'[{record.severity}] [{record.logger}]: {record.text}'))

    def error(self, error: BaseException) -> None:
        """Add an exception that a callback raised; one from the same line is only counted."""
        troubles.remember(self._name, error)
        where, what = where_and_what(error)
        goes_on = in_language_here(f'{self._title} goes on')
        lines = [f'  {in_language_here(line.strip())}' for line in where.splitlines()]
        text = '\n'.join([*filter(None, [what]), *lines, f'  {goes_on}'])
        self._add(PanelEntry(text, where=f'{type(error).__name__} {where}'))
        if not notebook.in_kernel():
            print(text, flush=True)

    def close(self, reason: str) -> None:
        """Take no more log lines, and show why the node has ended.

        The panel of a node that was stopped without any entry disappears.
        """
        if reason == STOPPED:
            troubles.forget(self._name)  # the next node of that name may be another's
        notebook.sync()
        notebook.listen_no_more(self.log)
        with self._lock:
            self._state = reason
        self._display.update(self._bundle())

    def _add(self, entry: PanelEntry) -> None:
        with self._lock:
            same = (e for e in self._entries if e.where is not None and e.where == entry.where)
            known = next(same, None)
            if known is not None:
                known.times += 1
            else:
                self._entries.append(entry)
            if len(self._entries) > LINES:
                self._entries.popleft()
                self._left_out += 1
        self._display.update_soon(self._bundle)

    def _bundle(self) -> dict[str, str]:
        with self._lock:
            lines = [str(entry) for entry in self._entries]
            if self._left_out:
                lines.insert(0, in_language_here(f'… {self._left_out} earlier lines'))
            state = self._state
        if state == STOPPED and not lines:
            return {'text/plain': '', 'text/html': ''}
        text = '\n'.join([f'{self._title}: {in_language_here(state)}', *lines])
        return {
            'text/plain': text,
            'text/html': f'<pre style="{STYLE}">{html.escape(text)}</pre>',
        }
