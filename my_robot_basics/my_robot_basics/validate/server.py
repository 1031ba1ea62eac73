"""A Jupyter server extension: *Validate* for JupyterLab's button, progress for the contents page.

The button starts `python -m my_robot_basics.validate` in a process of its own and passes its
lines on as they come, so that the student's server is not blocked.
"""

import asyncio
import contextlib
import json
import os
import signal
import sys
from pathlib import Path

from jupyter_server.base.handlers import APIHandler
from jupyter_server.serverapp import ServerApp
from jupyter_server.utils import url_path_join
from tornado import iostream, web

from my_robot_basics.language.speaking import language_of
from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.harmless_addresses import make_addresses_harmless
from my_robot_basics.validate.progress.passed_answers import default_path
from my_robot_basics.validate.progress.progress import read_progress
from my_robot_basics.validate.reports.report_words import front_end_texts
from my_robot_basics.validate.served import path_below

ADDRESS = 'my_robot_basics/validate'
PROGRESS_ADDRESS = 'my_robot_basics/progress'
MAX_LINE_BYTES = 2**26
"""The longest line: a report with its pictures is one line."""
STOP_TIMEOUT_SEC = 15.0


class ValidateHandler(APIHandler):
    """POST takes {"path": ...} and answers with lines of JSON: progress, at the end a report.

    GET takes ?path= and answers with the texts of the button and the dialog.
    """

    _process: asyncio.subprocess.Process | None = None

    @web.authenticated
    async def get(self) -> None:
        """Answer with the words of the button and its dialog, in the language of ?path=."""
        path = self._notebook({'path': self.get_query_argument('path')})
        self.finish({'words': await asyncio.to_thread(_words_for, path)})

    @web.authenticated
    async def post(self) -> None:
        """Validate a notebook below the server's root."""
        path = self._notebook(self.get_json_body() or {})
        self.set_header('Content-Type', 'application/x-ndjson')
        self._process = await asyncio.create_subprocess_exec(
            *(sys.executable, '-P', '-m', 'my_robot_basics.validate', '--json', str(path)),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            limit=MAX_LINE_BYTES,
        )
        try:
            await self._pass_on(self._process)
        except iostream.StreamClosedError:
            _interrupt(self._process)  # the dialog was closed
        finally:
            await _end_of(self._process)

    def on_connection_close(self) -> None:
        """End the process when the dialog is closed."""
        super().on_connection_close()
        if self._process is not None:
            _interrupt(self._process)

    def _notebook(self, body: dict) -> Path:
        assert self.serverapp is not None  # a handler has one
        return path_below(self.serverapp, str(body.get('path', '')))

    async def _pass_on(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None  # both are pipes
        assert process.stderr is not None
        errors = asyncio.create_task(process.stderr.read())
        said = b'{}'
        async for line in process.stdout:
            said = line
            self.write(line)
            await self.flush()
        trace = (await errors).decode(errors='replace')
        if not {'report', 'failed'} & json.loads(said).keys():
            self.log.error('Validate failed: %s', trace)
            why = (trace.strip().splitlines() or ['it ended without a message'])[-1]
            self.write(json.dumps({'failed': f'Validate itself failed: {why}'}) + '\n')


def _words_for(path: Path) -> dict[str, str]:
    """Return the words in a notebook's language; {} if it can't be read: Validate reports that."""
    try:
        metadata = json.loads(path.read_bytes())['metadata']
        return front_end_texts(language_of(metadata))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def _interrupt(process: asyncio.subprocess.Process) -> None:
    """Send SIGINT, on which the process ends its kernels and itself."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process.pid, signal.SIGINT)


async def _end_of(process: asyncio.subprocess.Process) -> None:
    try:
        await asyncio.wait_for(process.wait(), STOP_TIMEOUT_SEC)
    except TimeoutError:
        process.kill()


class ProgressHandler(APIHandler):
    """Answers ?path=, a contents page below the server's root, with the progress as JSON."""

    @web.authenticated
    async def get(self) -> None:
        """Read the page, the lessons beside it and the passed answers."""
        assert self.serverapp is not None  # a handler has one
        page = path_below(self.serverapp, self.get_query_argument('path'))
        try:
            told = await asyncio.to_thread(read_progress, page, default_path())
        except CourseError as error:
            self.finish({'failed': str(error)})
        else:
            self.finish(told.as_data())


def _jupyter_server_extension_points() -> list[dict[str, str]]:
    return [{'module': 'my_robot_basics.validate.server'}]


def _load_jupyter_server_extension(server: ServerApp) -> None:
    make_addresses_harmless()
    handlers = {ADDRESS: ValidateHandler, PROGRESS_ADDRESS: ProgressHandler}
    base = server.web_app.settings['base_url']
    server.web_app.add_handlers('.*$', [(url_path_join(base, a), h) for a, h in handlers.items()])
