"""What a kernel says while it runs a cell, on three channels at once."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable

import zmq
from jupyter_client import AsyncKernelClient

from my_robot_basics.validate.limits import MAX_MESSAGE_PARTS
from my_robot_basics.validate.outputs import CellRun, Displays

OUTPUT_GRACE_SEC = 2.0
"""How long a cell's last outputs may come after its reply."""

OnInput = Callable[[str], Awaitable[str]]
"""Answers a kernel's input() request."""


class Messages:
    """The messages of one kernel."""

    def __init__(self, client: AsyncKernelClient) -> None:
        """Read from a client whose channels are open."""
        self._client = client
        self._displays = Displays()

    @contextlib.asynccontextmanager
    async def run(
        self,
        code: str,
        result: CellRun,
        *,
        on_input: OnInput | None = None,
        expressions: dict[str, str] | None = None,
    ) -> AsyncIterator[asyncio.Future]:
        """Let the kernel run a cell; what this gives is done when the cell is. Nobody waits on.

        Afterwards nothing is read for that cell any more.
        """
        request = self._client.execute(
            code,
            store_history=False,
            user_expressions=expressions,
            allow_stdin=on_input is not None,
            stop_on_error=False,
        )
        done = asyncio.ensure_future(self.follow(request, result, on_input))
        try:
            yield done
        finally:
            done.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await done

    async def follow(self, request: str, result: CellRun, on_input: OnInput | None) -> None:
        """Gather a cell's outputs until the kernel has replied and is idle again."""
        outputs = asyncio.ensure_future(self._gather_outputs(request, result))
        inputs = asyncio.ensure_future(self._answer_inputs(request, on_input))
        reply = asyncio.ensure_future(next_message(self._client.get_shell_msg, request))
        try:
            await asyncio.wait([inputs, reply], return_when=asyncio.FIRST_COMPLETED)
            if inputs.done():
                inputs.result()  # it only ends by an exception
            content = (await reply)[1]
            # an idle message may be lost: a kernel that floods its socket is not waited for
            await asyncio.wait([outputs], timeout=OUTPUT_GRACE_SEC)
            result.conclude(content)
        finally:
            for task in (outputs, inputs, reply):
                task.cancel()

    async def _gather_outputs(self, request: str, result: CellRun) -> None:
        while True:
            kind, content = await next_message(
                self._client.get_iopub_msg,
                request,
                also='update_display_data',
                pass_over=result.pass_over,
            )
            if kind == 'status' and content.get('execution_state') == 'idle':
                return
            if kind == 'update_display_data':
                self._displays.update(content)
            elif kind == 'clear_output':
                result.clear()
            else:
                self._displays.remember(content, result, result.keep(kind, content))

    async def _answer_inputs(self, request: str, on_input: OnInput | None) -> None:
        while True:
            _, content = await next_message(self._client.get_stdin_msg, request)
            if on_input is not None:
                self._client.input(await on_input(str(content.get('prompt'))))


def unpacked(raw: bytes) -> object:
    """Read a part of a message, which is JSON. Raises ValueError where that would take memory."""
    parts = raw.count(b'{') + raw.count(b'[')
    if parts > MAX_MESSAGE_PARTS:
        raise ValueError(f'{parts:,} objects and lists in a message')
    return json.loads(raw)


async def next_message(
    get: Callable[..., Awaitable[dict]],
    request: str,
    *,
    also: str = '',
    pass_over: Callable[[dict], None] = lambda content: None,
) -> tuple[str, dict]:
    """Return type and content of the next message that belongs to a request.

    The student's code holds its kernel's sockets and may send anything at all: what is not a
    message is passed over.
    """
    while True:
        await asyncio.sleep(0)  # a flood of messages must not keep time limits waiting
        try:
            message = await get(timeout=None)
        except zmq.ZMQError:
            raise
        except Exception:  # whatever the reading of a forged message raises
            continue
        parent, content = message['parent_header'], message['content']
        ours = isinstance(parent, dict) and parent.get('msg_id') == request
        if isinstance(content, dict) and (ours or message['msg_type'] == also):
            return message['msg_type'], content
        pass_over(content)
