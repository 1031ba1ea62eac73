import base64
import struct
import zlib

import pytest
from course_maker import PIXEL
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.pictures import MAX_PIXELS, why_not_shown

from grader.notebook.raw_notebook import _pictures
from grader.report.page_parts import show_data


def png(width, height):
    """Return a PNG of few bytes and as many pixels as asked for, all of them black."""

    def chunk(kind, data):
        return (
            struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
        )

    header = struct.pack('>IIBBBBB', width, height, 1, 0, 0, 0, 0)
    row = bytes(1 + (width + 7) // 8)
    packer = zlib.compressobj(9)
    body = b''.join(packer.compress(row) for _ in range(height)) + packer.flush()
    raw = b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + chunk(b'IDAT', body)
    return base64.b64encode(raw + chunk(b'IEND', b'')).decode()


def jpeg(width, height):
    filled = b'\xff\xd8' + b'\xff\xe0' + struct.pack('>H', 16) + bytes(14)
    frame = b'\xff\xff\xc2' + struct.pack('>HBHHB', 17, 8, height, width, 3) + bytes(9)
    return base64.b64encode(filled + frame).decode()


BOMB = png(16_000, 16_000)
SHOWN = [PIXEL, png(640, 480), jpeg(4_000, 3_000), '\n'.join([PIXEL[:40], PIXEL[40:]])]
NOT_SHOWN = [
    BOMB, jpeg(16_000, 16_000), png(0, 5), jpeg(5, 0), '', 'no base64', 'aGk=', PIXEL[:20],
    base64.b64encode(b'\xff\xd8\xff').decode(),
    base64.b64encode(b'<svg xmlns="http://www.w3.org/2000/svg"/>').decode(),
    base64.b64encode(b'GIF89a' + struct.pack('<HH', 60_000, 60_000)).decode(),
]  # fmt: skip


@pytest.mark.parametrize('encoded', SHOWN)
def test_ordinary_pictures_are_shown(encoded):
    assert why_not_shown(encoded) == ''


@pytest.mark.parametrize('encoded', NOT_SHOWN)
def test_huge_pictures_and_data_that_is_no_picture_are_not_shown(encoded):
    assert why_not_shown(encoded)


def test_a_small_file_of_a_huge_picture_is_refused_for_its_pixels():
    assert len(BOMB) < 60_000
    assert '16,000 × 16,000' in why_not_shown(BOMB)
    assert MAX_PIXELS < 16_000**2


def test_a_huge_picture_is_left_out_of_outputs_pages_and_attachments():
    run = CellRun()
    output = run.keep('display_data', {'data': {'image/png': BOMB, 'text/plain': 'x'}})
    said = '[a picture of 16,000 × 16,000 pixels, of 25,000,000 at most, was left out]'
    assert output.data == {'text/plain': said}
    [piece] = show_data({'image/png': BOMB}, 'a plot')
    assert (piece.kind, piece.content) == ('text', said)
    assert _pictures({'a.png': {'image/png': BOMB}, 'b.png': {'image/png': PIXEL}}) == {
        'b.png': {'image/png': PIXEL}
    }
