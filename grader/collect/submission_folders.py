"""Folders of one submission each: written whole, compared, and kept beside earlier ones."""

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path

from grader.notebook.submission import SECRET, TIMESTAMP


def contents(folder: Path) -> dict[str, bytes]:
    """Return the digests of a submission's files, without what the exchange put beside them."""
    ours = (TIMESTAMP, SECRET)
    files = (path for path in folder.iterdir() if path.is_file() and path.name not in ours)
    return digests({path.name: path for path in files})


def digests(files: Mapping[str, Path]) -> dict[str, bytes]:
    """Return what tells contents apart: several submissions of 200 MB would fill the memory."""
    found = {}
    for name, path in files.items():
        with path.open('rb') as file:
            found[name] = hashlib.file_digest(file, 'sha256').digest()
    return found


def contents_of_earlier(shelf: Path) -> list[dict[str, bytes]]:
    """Return the digests of each submission that is kept there."""
    return [contents(folder) for folder in shelf.glob('*/submitted')]


def writer(
    files: Mapping[str, Path], handed_in: datetime | None, secret: Path | None = None
) -> Callable[[Path], None]:
    """Return what writes a submission into an empty folder, its time as nbgrader does."""

    def write(folder: Path) -> None:
        for name, path in files.items():
            shutil.copyfile(path, folder / name)
        if handed_in:
            time = handed_in.strftime('%Y-%m-%d %H:%M:%S.%f UTC')
            (folder / TIMESTAMP).write_text(time, encoding='ascii')
        if secret:
            shutil.copyfile(secret, folder / SECRET)

    return write


def within(name: str, write: Callable[[Path], None]) -> Callable[[Path], None]:
    """Return what writes into a folder of that name in the folder it gets."""

    def write_within(folder: Path) -> None:
        (folder / name).mkdir()
        write(folder / name)

    return write_within


def put_numbered(write: Callable[[Path], None], shelf: Path) -> Path:
    """Put a folder beside those of earlier times; return it."""
    numbers = [int(path.name) for path in shelf.glob('*') if path.name.isdecimal()]
    place = shelf / str(max(numbers, default=0) + 1)
    put_whole(write, place)
    return place


def put_whole(write: Callable[[Path], None], place: Path) -> None:
    """Write a folder aside and put it in its place: nobody ever finds half of it."""
    place.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix='.new-', dir=place.parents[2]) as aside:
        new = Path(aside, 'new')
        new.mkdir()
        write(new)
        if place.exists():
            place.rename(Path(aside, 'old'))
        new.rename(place)
