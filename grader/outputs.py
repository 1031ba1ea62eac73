"""What one cell put out: gathered from a kernel's messages, bounded in size."""

from dataclasses import dataclass, field

import nbformat
from nbformat import NotebookNode

MAX_OUTPUT_CHARACTERS = 200_000
"""What is kept of one cell's output; the rest is drained and counted."""

_OUTPUTS = ('stream', 'display_data', 'execute_result', 'error')


@dataclass
class CellRun:
    """What came of one cell."""

    outputs: list[NotebookNode] = field(default_factory=list)
    error: NotebookNode | None = None
    """The `error` output, if the cell raised one."""
    expressions: dict = field(default_factory=dict)
    """The reply's user_expressions."""
    timed_out: bool = False
    died: bool = False
    _kept: int = 0
    _dropped: int = 0

    @property
    def ran_to_end(self) -> bool:
        """Whether the kernel itself reported that the cell was done, without an error."""
        return not (self.timed_out or self.died or self.error)

    def keep(self, message: dict) -> NotebookNode | None:
        """Keep an IOPub message's output while there is room; return it if it can be updated."""
        if message['msg_type'] == 'clear_output':
            self.outputs.clear()
        if message['msg_type'] not in _OUTPUTS:
            return None
        output = nbformat.v4.output_from_msg(message)
        if output.output_type == 'error':
            self.error = output
        if output.output_type == 'stream':
            self._keep_text(output)
            return None
        size = _size(output)
        if size > self._room and output.output_type != 'error':
            self._dropped += size
            return None
        self._kept += size
        self.outputs.append(output)
        return output

    def close(self) -> None:
        """Say at the end what was not kept."""
        if self._dropped:
            text = f'\n[{self._dropped:,} more characters of output were not kept]\n'
            self.outputs.append(nbformat.v4.new_output('stream', name='stdout', text=text))

    @property
    def _room(self) -> int:
        return max(0, MAX_OUTPUT_CHARACTERS - self._kept)

    def _keep_text(self, output: NotebookNode) -> None:
        kept = output.text[: self._room]
        self._kept += len(kept)
        self._dropped += len(output.text) - len(kept)
        last = self.outputs[-1] if self.outputs else None
        if last is not None and last.get('name') == output.name:
            last.text += kept
        elif kept:
            output.text = kept
            self.outputs.append(output)


class Displays:
    """The outputs of one kernel that later messages may update, by display id."""

    def __init__(self) -> None:
        """Know no output yet."""
        self._outputs: dict[str, list[NotebookNode]] = {}

    def remember(self, message: dict, output: NotebookNode | None) -> None:
        """Note an output under the display id of the message that brought it, if it has one."""
        display_id = _display_id(message)
        if display_id and output is not None:
            self._outputs.setdefault(display_id, []).append(output)

    def update(self, message: dict) -> None:
        """Replace what an update_display_data message names, unless it has grown too large."""
        if _size(message['content']) <= MAX_OUTPUT_CHARACTERS:
            for output in self._outputs.get(_display_id(message), ()):
                output.data = nbformat.from_dict(message['content']['data'])


def _display_id(message: dict) -> str | None:
    return message['content'].get('transient', {}).get('display_id')


def _size(content: object) -> int:
    return len(str(content))
