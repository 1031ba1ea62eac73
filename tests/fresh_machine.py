"""What a machine has on which nobody has used this course yet."""

import os
import shutil
import sys
from pathlib import Path

KEPT = ('LANG', 'http_proxy', 'https_proxy', 'no_proxy', 'SSL_CERT_FILE', 'PIP_CONFIG_FILE')
KEPT += ('HTTP_PROXY', 'HTTPS_PROXY', 'PIP_INDEX_URL', 'UV_INDEX_URL', 'UV_DEFAULT_INDEX')


def fresh_environment(folder: Path) -> dict[str, str]:
    """Return the variables of a fresh machine: no .venv, no settings, a home in `folder`."""
    home, tools = folder / 'home', folder / 'tools'
    home.mkdir()
    tools.mkdir()
    (tools / 'python3').symlink_to(sys._base_executable)
    environment = {name: os.environ[name] for name in KEPT if name in os.environ}
    environment |= {'HOME': str(home), 'PATH': f'{tools}:/usr/local/bin:/usr/bin:/bin'}
    for name in ('.config/pip/pip.conf', '.pip/pip.conf'):  # how this machine reaches a registry
        if (there := Path.home() / name).is_file():
            (home / name).parent.mkdir(parents=True)
            shutil.copy(there, home / name)
    return environment
