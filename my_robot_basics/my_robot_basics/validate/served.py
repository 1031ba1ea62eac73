"""Files that a Jupyter server serves."""

from pathlib import Path

from jupyter_server.serverapp import ServerApp
from tornado import web


def path_below(server: ServerApp, path: str) -> Path:
    """Return a file below the server's root. Raises HTTPError if it is outside."""
    root = Path(server.root_dir).expanduser().resolve()
    found = (root / path.lstrip('/')).resolve()
    if not found.is_relative_to(root):
        raise web.HTTPError(403, 'the notebook is outside of the folder that is served')
    return found
