"""Whether this process is a notebook's kernel. Imports nothing that is slow."""

import sys
from typing import Any


def shell() -> Any:
    """Return IPython's shell if it runs in a kernel, else None."""
    if 'IPython' not in sys.modules:
        return None
    found = sys.modules['IPython'].get_ipython()
    return found if hasattr(found, 'kernel') else None
