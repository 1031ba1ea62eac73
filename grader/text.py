"""Make text that students wrote safe to print, to tabulate and to open in a spreadsheet."""

from my_robot_basics.validate.text import columns as columns
from my_robot_basics.validate.text import printable as printable
from my_robot_basics.validate.text import shorten as shorten


def pad(text: str, width: int) -> str:
    """Fill a line up with spaces to `width` columns."""
    return text + ' ' * (width - columns(text))


def spreadsheet_safe(text: object) -> str:
    """Return a CSV field that no spreadsheet takes for a formula."""
    line = printable(text)
    return f"'{line}" if line.startswith(('=', '+', '-', '@')) else line
