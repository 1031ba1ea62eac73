"""Addresses of a Jupyter server run nothing that a notebook, or the address itself, chooses.

A picture in a notebook calls any address of the server as soon as JupyterLab shows it, without a
cell that is run. Two of them ran Python code that students had handed in beside their notebooks,
with the rights of whoever opened one; a link to a third ran JavaScript that was written into the
link. No option prevents that, so these are patches.
"""

import os
import sys
from typing import Any

from jupyter_server.nbconvert import handlers as exports
from markupsafe import escape
from tornado import web

_FORMGRADER = 'nbgrader.server_extensions.formgrader.handlers'
_get_exporter = exports.get_exporter


def make_addresses_harmless() -> None:
    """Patch the formgrader, if this server has it, and exports."""
    if formgrader := sys.modules.get(_FORMGRADER):
        _open_one_course(formgrader.FormgraderHandler)
        _show_names_as_text(formgrader.BaseHandler)
    exports.get_exporter = _exporter_of_known_formats


def _open_one_course(handler_class: Any) -> None:
    """Let the formgrader open the folder in which the server was started, and no other one.

    Its address may name a folder, and nbgrader runs the `nbgrader_config.py` there.
    """
    opened, started_in = handler_class.get, os.getcwd()

    def get(handler: Any) -> Any:
        path = handler.get_argument('path', '')
        if path and os.path.abspath(path) != started_in:
            raise web.HTTPError(
                403, f'this formgrader opens {started_in} alone: start JupyterLab in the other'
            )
        return opened(handler)

    handler_class.get = get


def _show_names_as_text(handler_class: Any) -> None:
    """Let the formgrader's pages show names that their addresses have as text.

    nbgrader puts them into HTML, and into texts of scripts, as they are.
    """
    rendered = handler_class.render

    def render(handler: Any, page: str, **values: Any) -> str:
        texts = {name: value for name, value in values.items() if isinstance(value, str)}
        shown = {name: escape(text).replace('\\', '&#92;') for name, text in texts.items()}
        return rendered(handler, page, **values | shown)

    handler_class.render = render


def _exporter_of_known_formats(format: str, **options: Any) -> Any:
    """Return an exporter; that of scripts imports no class that a notebook's metadata name."""
    from nbconvert.exporters.script import ScriptExporter  # slow, and most servers export nothing

    exporter: Any = _get_exporter(format, **options)
    is_script = isinstance(exporter, ScriptExporter)
    if is_script:
        export = exporter.from_notebook_node

        def from_notebook_node(notebook: Any, *more: Any, **others: Any) -> Any:
            language = notebook.metadata.get('language_info', {})
            if '.' in str(language.get('nbconvert_exporter')):
                del language['nbconvert_exporter']
            return export(notebook, *more, **others)

        exporter.from_notebook_node = from_notebook_node
    return exporter
