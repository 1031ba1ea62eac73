"""Where matplotlib keeps its list of fonts, without importing it: that takes 0.15 s."""

import os
from pathlib import Path


def font_cache() -> str:
    """Return the same as matplotlib.get_cachedir().

    Where that would have to be made, or is not to be written to, matplotlib says what else to do.
    """
    named = os.environ.get('MPLCONFIGDIR')
    base = os.environ.get('XDG_CACHE_HOME')
    try:
        folder = Path(named) if named else Path(base or Path.home() / '.cache', 'matplotlib')
        folder = folder.resolve()
        if folder.is_dir() and os.access(folder, os.W_OK):
            return str(folder)
    except (OSError, RuntimeError):  # a loop of links, or no home
        pass
    import matplotlib

    return matplotlib.get_cachedir()
