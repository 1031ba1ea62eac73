"""Whether a picture that somebody else made can be shown: what it takes is not what it weighs.

40 kB of PNG can hold 16,000 times 16,000 pixels: a gigabyte in whatever shows them.
"""

import base64
import binascii
import struct

MAX_PIXELS = 25_000_000
"""A photo has half of them; a plot of a lesson, a fiftieth."""
KINDS = ('image/png', 'image/jpeg')

_PNG, _JPEG = b'\x89PNG\r\n\x1a\n', b'\xff\xd8'
_NO_FRAMES = (0xC4, 0xC8, 0xCC)
"""Among the markers of JPEG frames; they begin something else."""


def why_not_shown(encoded: str) -> str:
    """Say why a picture in base64 is better not shown, in a phrase; '' for one that can be.

    Whatever it is called: browsers look at what it is.
    """
    size = _size(encoded)
    if size is None:
        return 'something that is not a PNG or JPEG'
    width, height = size
    if not 0 < width * height <= MAX_PIXELS:
        return f'a picture of {width:,} × {height:,} pixels, of {MAX_PIXELS:,} at most,'
    return ''


def _size(encoded: str) -> tuple[int, int] | None:
    """Return width and height in pixels, as its header says; None where it has none."""
    try:
        raw = base64.b64decode(''.join(encoded.split()), validate=True)
        if raw.startswith(_PNG) and raw[12:16] == b'IHDR':
            return struct.unpack_from('>II', raw, 16)
        return _size_of_jpeg(raw) if raw.startswith(_JPEG) else None
    except (binascii.Error, ValueError, struct.error, IndexError):
        return None


def _size_of_jpeg(raw: bytes) -> tuple[int, int] | None:
    at = 2
    while raw[at] == 0xFF:
        marker = raw[at + 1]
        if marker == 0xFF:  # fills up
            at += 1
            continue
        if 0xC0 <= marker <= 0xCF and marker not in _NO_FRAMES:
            height, width = struct.unpack_from('>HH', raw, at + 5)
            return width, height
        at += 2 + struct.unpack_from('>H', raw, at + 2)[0]
    return None
