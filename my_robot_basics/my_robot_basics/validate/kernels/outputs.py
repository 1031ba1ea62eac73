"""The outputs of one cell: collected from a kernel's messages, bounded in size.

A student's code may forge messages: whatever does not have the form of an output is ignored.
"""

from dataclasses import dataclass, field

import nbformat
from nbformat import NotebookNode

from my_robot_basics.validate.kernels.limits import FLOOD_CHARACTERS, MAX_MESSAGE_BYTES
from my_robot_basics.validate.kernels.safe_outputs import safe_output

MAX_OUTPUT_CHARACTERS = 200_000
"""How much is kept of one cell's output; the rest is read and counted only."""

CUT_OFF = (
    f'sent over {MAX_MESSAGE_BYTES / 1e6:.0f} MB at once, or closed a connection of its '
    'kernel, which was ended: nothing that it says could be received any more'
)
"""The message about a cell whose kernel was cut off, as a predicate."""
EXITS = 'it calls exit()'
"""The message about a cell that has asked its kernel to end."""
_OVERHEAD = 100
"""Characters that each output counts besides its text: many small ones cost memory, too."""


@dataclass
class CellRun:
    """The result of running one cell."""

    outputs: list[NotebookNode] = field(default_factory=list)
    error: NotebookNode | None = None
    """The `error` output, if the cell raised one."""
    status: str | None = None
    """How the cell ended, as the kernel replied: 'ok', 'error', or None without a reply."""
    expressions: object = None
    """The reply's user_expressions, as the kernel sent them."""
    timed_out: bool = False
    cut_after_sec: float = 0.0
    """After how many seconds *Validate* gave up student code for which grading waits longer."""
    given_up: str = ''
    """Why *Validate* gave up a check for which grading waits longer; else empty."""
    replies_sec: float = 0.0
    """How long the student's code took for its replies to a check that the grader gave up."""
    died: bool = False
    cut_off: bool = False
    """Whether its kernel had to be killed because nothing more could be received from it."""
    leaves: bool = False
    """Whether its kernel ends after this cell, which has called `exit()`."""
    ending: str = ''
    """How the student's kernel or its processes ended, if the student's code caused it."""
    crash: str = ''
    """The signal by which the test's kernel crashed, such as SIGSEGV."""
    _kept: int = 0
    _dropped: int = 0
    _foreign: int = 0

    @property
    def ran_to_end(self) -> bool:
        """Whether the kernel reported the cell's end, without an error or a timeout."""
        return self.status == 'ok' and not (self.timed_out or self.died or self.error)

    @property
    def flooded(self) -> bool:
        """Whether it printed more than FLOOD_CHARACTERS, or its kernel was cut off."""
        return self.cut_off or self._dropped + self._foreign > FLOOD_CHARACTERS

    def pass_over(self, content: dict) -> None:
        """Count a message that is not an output of this cell, but of a thread, for instance."""
        self._foreign += _size(content)

    def keep(self, kind: str, content: dict) -> NotebookNode | None:
        """Keep an output if its size allows; return it if a later message can update it."""
        output = safe_output(kind, content)
        if output is None:
            return None
        if kind == 'stream':
            self._keep_text(output)
            return None
        size = _size(output)
        first_error = kind == 'error' and self.error is None
        if kind == 'error':
            self.error = output
        if size > self._room and not first_error:
            self._dropped += size
            return None
        self._kept += size
        self.outputs.append(output)
        return output

    def replace(self, output: NotebookNode, data: dict, *, size: int) -> None:
        """Replace the data of a kept output by data of that size, if the limit allows."""
        growth = size - _size(output.data)
        if growth <= self._room:
            self._kept += growth
            output.data = nbformat.from_dict(data)

    def clear(self) -> None:
        """Drop the outputs so far."""
        self.outputs.clear()
        self._kept = 0

    def conclude(self, reply: dict) -> None:
        """Store what the kernel's reply says, and its error if no output had one."""
        self.status, self.expressions = reply.get('status'), reply.get('user_expressions')
        if self.status == 'error' and self.error is None:
            self.keep('error', reply)
        if any(map(_asks_to_exit, _list(reply.get('payload')))):
            self.leaves, self.ending = True, EXITS

    def close(self) -> None:
        """Append a note about dropped output, if there is any."""
        if self._dropped:
            text = f'\n[{self._dropped:,} more characters of output were not kept]\n'
            self.outputs.append(nbformat.v4.new_output('stream', name='stdout', text=text))

    @property
    def _room(self) -> int:
        return max(0, MAX_OUTPUT_CHARACTERS - self._kept)

    def _keep_text(self, output: NotebookNode) -> None:
        last = self.outputs[-1] if self.outputs else None
        if last is not None and last.get('name') != output.name:
            last = None
        kept = output.text[: max(0, self._room - (_OVERHEAD if last is None else 0))]
        self._dropped += len(output.text) - len(kept)
        if last is not None:
            last.text += kept
            self._kept += len(kept)
        elif kept:
            output.text = kept
            self.outputs.append(output)
            self._kept += len(kept) + _OVERHEAD


class Displays:
    """The outputs of one kernel that later messages may update, by display id."""

    def __init__(self) -> None:
        """Begin without outputs."""
        self._outputs: dict[str, list[tuple[CellRun, NotebookNode]]] = {}

    def remember(self, content: dict, run: CellRun, output: NotebookNode | None) -> None:
        """Store an output under the display id of its message, if it has one."""
        display_id = _display_id(content)
        if display_id and output is not None:
            self._outputs.setdefault(display_id, []).append((run, output))

    def update(self, content: dict) -> None:
        """Replace the outputs with the display id of an update_display_data message."""
        new, display_id = safe_output('display_data', content), _display_id(content)
        if new is None or display_id is None:
            return
        size = _size(new.data)  # computed once: thousands of small outputs may share an id
        for run, output in self._outputs.get(display_id, ()):
            run.replace(output, new.data, size=size)


def _list(value: object) -> list:
    return value if isinstance(value, list) else []


def _asks_to_exit(payload: object) -> bool:
    match payload:
        case {'source': 'ask_exit', **how}:
            return not how.get('keepkernel')
    return False


def _display_id(content: dict) -> str | None:
    match content:
        case {'transient': {'display_id': str(display_id)}}:
            return display_id
    return None


def _size(content: object) -> int:
    return _OVERHEAD + len(str(content))
