"""Whether an untrusted picture can be shown: a small file may take much memory when decoded.

A PNG of 40 kB can have 16,000 × 16,000 pixels, which take a gigabyte in a browser.
"""

import base64
import binascii
import struct

MAX_PIXELS = 25_000_000
"""A photo has about half as many; a plot of a lesson, a fiftieth."""
KINDS = ('image/png', 'image/jpeg')

_PNG, _JPEG = b'\x89PNG\r\n\x1a\n', b'\xff\xd8'
_NO_FRAMES = (0xC4, 0xC8, 0xCC)
"""Markers in the range of JPEG's frame markers that do not begin a frame."""


def why_not_shown(encoded: str) -> str:
    """Say in a phrase why a base64 picture must not be shown; '' if it may be.

    The content decides, not the declared MIME type: browsers do the same.
    """
    size = _size(encoded)
    if size is None:
        return 'something that is not a PNG or JPEG'
    width, height = size
    if not 0 < width * height <= MAX_PIXELS:
        return f'a picture of {width:,} × {height:,} pixels, of {MAX_PIXELS:,} at most,'
    return ''


def _size(encoded: str) -> tuple[int, int] | None:
    """Return width and height in pixels from a picture's header; None if it has none."""
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
        if marker == 0xFF:  # a fill byte
            at += 1
            continue
        if 0xC0 <= marker <= 0xCF and marker not in _NO_FRAMES:
            height, width = struct.unpack_from('>HH', raw, at + 5)
            return width, height
        at += 2 + struct.unpack_from('>H', raw, at + 2)[0]
    return None
