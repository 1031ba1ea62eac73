"""Receive the messages of a kernel that runs a cell, on three channels at once."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator, Awaitable, Callable

import zmq
from jupyter_client import AsyncKernelClient

from my_robot_basics.validate.kernels.limits import MAX_MESSAGE_PARTS
from my_robot_basics.validate.kernels.outputs import CellRun, Displays

OUTPUT_GRACE_SEC = 2.0
"""How long after a cell's reply its last outputs may arrive."""

OnInput = Callable[[str], Awaitable[str]]
"""Answers a kernel's input() request."""


class Messages:
    """Runs cells in one kernel and collects their messages."""

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
        """Start a cell in the kernel and give a future that is done when the cell is.

        When the block ends, messages of that cell are no longer read.
        """
        request = self._client.execute(
            code,
            # a request is no cell: no hooks run, and no input is published
            silent=expressions is not None,
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
        """Collect a cell's outputs until the kernel has replied and is idle again."""
        outputs = asyncio.ensure_future(self._gather_outputs(request, result))
        inputs = asyncio.ensure_future(self._answer_inputs(request, on_input))
        reply = asyncio.ensure_future(next_message(self._client.get_shell_msg, request))
        try:
            await asyncio.wait([inputs, reply], return_when=asyncio.FIRST_COMPLETED)
            if inputs.done():
                inputs.result()  # it can end only by an exception, which this raises
            content = (await reply)[1]
            # with a timeout: the idle message may be lost if a kernel floods its socket
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


def parse_message_part(raw: bytes) -> object:
    """Parse a message part, which is JSON. Raises ValueError if it would take too much memory."""
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

    The student's code can use its kernel's sockets and send anything: invalid messages are
    ignored. `also` is a type that is accepted from any request; `pass_over` gets the others.
    """
    while True:
        await asyncio.sleep(0)  # a flood of messages must not delay the time limits
        try:
            message = await get(timeout=None)
        except zmq.ZMQError:
            raise
        except Exception:  # reading a forged message may raise anything
            continue
        parent, content = message['parent_header'], message['content']
        ours = isinstance(parent, dict) and parent.get('msg_id') == request
        if isinstance(content, dict) and (ours or message['msg_type'] == also):
            return message['msg_type'], content
        pass_over(content)
