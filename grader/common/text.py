"""Make text of students safe to print, to show in tables and to open in a spreadsheet."""

import csv
import io
import re
from collections.abc import Iterable, Sequence

from my_robot_basics.validate.text import columns as columns
from my_robot_basics.validate.text import printable as printable
from my_robot_basics.validate.text import shorten as shorten
from my_robot_basics.validate.text import visible as visible

BYTE_ORDER_MARK = '\ufeff'
_SURROGATE = re.compile('[\ud800-\udfff]')
"""Python's placeholder for a byte of a name that is not UTF-8; it can't be encoded."""


def storable(text: str) -> str:
    """Return text that a database can store: bytes of a name that are not UTF-8 are escaped."""
    return _SURROGATE.sub(_spelled_byte, text)


def _spelled_byte(found: re.Match) -> str:
    byte = ord(found[0]) - 0xDC00  # as os.fsdecode puts it
    return f'\\x{byte:02x}' if 0x80 <= byte <= 0xFF else f'\\u{ord(found[0]):x}'


def pad(text: str, width: int) -> str:
    """Append spaces to a text until it is `width` columns wide."""
    return text + ' ' * (width - columns(text))


# in some locales ';' or tabs separate fields, because numbers have a comma; quotes begin a field
_FORMULA = re.compile(r'(^|[,;|])(["\s]*)(?=[=+\-@＝＋－＠])')
_NUMBER = re.compile(r'["\s]*[-+]?\d+(\.\d+)?(e[-+]?\d+)?["\s]*([,;|)\]}]|$)')


def spreadsheet_safe(text: object) -> str:
    """Return a CSV field that no spreadsheet reads as a formula, wherever it splits the line."""
    line = printable(text)
    if line == '-':  # platforms write this for an empty value
        return line

    def quoted(found: re.Match) -> str:
        if found[1] and _NUMBER.match(line, found.end(1)):  # a number after a separator
            return found[0]
        return f"{found[0]}'"

    return _FORMULA.sub(quoted, line)


def spreadsheet_table(rows: Iterable[Sequence[object]]) -> str:
    """Return rows as CSV for a spreadsheet; numbers stay, and all other fields are made safe.

    It begins with a byte-order mark: without it, Excel does not read it as UTF-8.
    """
    text = io.StringIO(newline='')
    table = csv.writer(text)
    for row in rows:
        table.writerow(
            [field if isinstance(field, int | float) else spreadsheet_safe(field) for field in row]
        )
    return BYTE_ORDER_MARK + text.getvalue()
