"""Files that are there whole or not at all, whatever happens while they are written."""

import os
from pathlib import Path


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that nobody ever finds half of it, not even after a power cut.

    Raises OSError, and leaves what was there before, when it can't be written.
    """
    raw = content.encode() if isinstance(content, str) else content
    aside = path.with_name(f'.{path.name}.new')
    try:
        with aside.open('wb') as file:
            file.write(raw)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
    except OSError:
        aside.unlink(missing_ok=True)
        raise
