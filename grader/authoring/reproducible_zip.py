"""A zip whose bytes are those of its files alone."""

import io
import zipfile
import zlib
from collections.abc import Collection
from datetime import datetime, timedelta

FIRST_DAY = datetime(2026, 1, 1)
DAYS = 28
"""A file's time is one of these days; a zip counts in steps of two seconds."""


def zipped(files: dict[str, bytes], executable: Collection[str]) -> bytes:
    """Return a zip of files by their paths; of these, the executable ones may be run."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, 'w') as box:
        for name, content in files.items():
            info = zipfile.ZipInfo(name, _time_of(content))
            info.create_system = 3  # Unix, whose rights are kept
            mode = 0o755 if name in executable else 0o644
            info.external_attr = (0o100000 | mode) << 16
            box.writestr(info, content, zipfile.ZIP_DEFLATED, 9)
    return packed.getvalue()


def _time_of(content: bytes) -> tuple[int, int, int, int, int, int]:
    """Return the time of a file: the same content always has the same, a changed one another.

    Where a new version is unpacked over the old one, Python goes on with the old bytecode of a
    file whose time and size have not changed.
    """
    at = FIRST_DAY + timedelta(seconds=zlib.crc32(content) % (DAYS * 43_200) * 2)
    return at.year, at.month, at.day, at.hour, at.minute, at.second
