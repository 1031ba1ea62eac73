"""Where matplotlib keeps its list of fonts, without importing it: that takes 0.15 s."""

import os
from pathlib import Path


def font_cache() -> str:
    """Return the same as matplotlib.get_cachedir().

    If that folder does not exist or is read-only, matplotlib itself is imported and asked.
    """
    named = os.environ.get('MPLCONFIGDIR')
    base = os.environ.get('XDG_CACHE_HOME')
    try:
        folder = Path(named) if named else Path(base or Path.home() / '.cache', 'matplotlib')
        folder = folder.resolve()
        if folder.is_dir() and os.access(folder, os.W_OK):
            return str(folder)
    except (OSError, RuntimeError):  # a loop of links, or no home folder
        pass
    import matplotlib

    return matplotlib.get_cachedir()
