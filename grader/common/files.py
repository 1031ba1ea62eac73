"""Write files atomically, completely or not at all; list folders of any size."""

import contextlib
import os
from datetime import datetime
from itertools import islice
from pathlib import Path


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that a reader never finds half of it, not even after a power cut.

    Raises OSError, and keeps the previous file, if it can't be written.
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
        with contextlib.suppress(OSError):  # if the name is too long, the file was not created
            aside.unlink()
        raise


def make_folder_for(time: datetime, parent: Path) -> Path:
    """Make a folder named after a time, with a number appended if it exists already."""
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


def first_names(descriptor: int, most: int) -> list[str]:
    """Return the sorted names in an open folder; `most` of them if it has more.

    A folder with millions of files is not read to its end.
    """
    with os.scandir(descriptor) as listed:
        return sorted(each.name for each in islice(listed, most))
