"""What to do about exceptions of Python and rclpy whose own words do not tell beginners."""

import re
import unicodedata

DECIMAL_COMMA = ', so a decimal comma may have made two numbers of one: write 0.2, and not 0,2'
_TWO_NUMBERS = re.compile(
    r"object has no attribute 'add_entity'"  # create_timer(0,2, …) takes the callback for a group
    r"|argument must be a string or a real number, not 'tuple'"  # period_sec = 0,2
    r"|could not convert string to float: '\d+[,，]\d"  # '0,2'
    r'|is not a ParameterDescriptor'  # declare_parameter('rate_hz', 5,0)
    r'|sleep\(\) takes exactly one argument \(2 given\)'
)
_CHARACTER = re.compile(r"invalid (?:non-printable )?character '?(.)'? \(U\+[0-9A-F]+\)")
_PLAIN = {
    '。': '.',
    '、': ',',
    '“': '"',
    '”': '"',
    '‘': "'",
    '’': "'",
    '−': '-',
    '–': '-',
    '×': '*',
}


def explained(told: str) -> str:
    """A sentence or clause that tells what was raised, with what to do behind it, if anything."""
    why = what_to_do(told)
    return told.rstrip('.') + why if why else told


def what_to_do(said: str) -> str:
    """A clause to put behind what was raised, such as 'AttributeError: …'; or ''."""
    if _TWO_NUMBERS.search(said):
        return DECIMAL_COMMA
    if found := _CHARACTER.search(said):
        other = found[1]
        plain = _PLAIN.get(other) or unicodedata.normalize('NFKC', other)
        if plain != other and plain.isascii():
            return f', so write `{plain}` in place of `{other}`: code takes plain characters alone'
    return ''
