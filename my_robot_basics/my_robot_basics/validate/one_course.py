"""nbgrader's formgrader opens the folder in which the server was started, and no other one.

Its address may name a folder, and nbgrader then runs the `nbgrader_config.py` there. A picture in
a notebook can call that address as soon as JupyterLab shows it: students who handed in such a
file had it run with the rights of whoever opened their notebook.
"""

import os
import sys
from typing import Any

from tornado import web

_HANDLERS = 'nbgrader.server_extensions.formgrader.handlers'


def open_one_course() -> None:
    """Patch the formgrader, if this server has it: no option can do it."""
    if handlers := sys.modules.get(_HANDLERS):
        opened, started_in = handlers.FormgraderHandler.get, os.getcwd()

        def get(handler: Any) -> Any:
            path = handler.get_argument('path', '')
            if path and os.path.abspath(path) != started_in:
                raise web.HTTPError(
                    403, f'this formgrader opens {started_in} alone: start JupyterLab in the other'
                )
            return opened(handler)

        handlers.FormgraderHandler.get = get
