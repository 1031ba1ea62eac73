"""Files that are there whole or not at all, whatever happens while they are written."""

import contextlib
import os
from datetime import datetime
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
        with contextlib.suppress(OSError):  # its name may be too long to begin with
            aside.unlink()
        raise


def make_folder_for(time: datetime, parent: Path) -> Path:
    """Make a folder named by a time; with a number after it if there is one already."""
    parent.mkdir(parents=True, exist_ok=True)
    name, number = time.strftime('%Y-%m-%d_%H-%M-%S'), 1
    while True:
        folder = parent / (name if number == 1 else f'{name}_{number}')
        try:
            folder.mkdir()
        except FileExistsError:
            number += 1
        else:
            return folder
