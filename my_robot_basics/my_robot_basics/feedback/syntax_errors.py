"""Hints for code that Python cannot parse, often as in C++; as in error_words."""

from my_robot_basics.feedback.error_words import Case

_AT = r'SyntaxError:\sinvalid\ssyntax\s\(line\s\d+:\s[^\'"#]*'
"""The text before a sign that is neither in a text nor in a comment; see `validate.trouble`."""

OF_SYNTAX = (
    Case(
        pattern=r'SyntaxError: invalid syntax[^(]*\(line \d+: ask\(\w+, guess=[^\'"]+\)\)',
        to_do=", so write a text in quotes, as in guess='/station', and commas between the values "
        'of a list',
    ),
    Case(pattern=rf'{_AT}(?:=<|=>)', to_do=', so write <= or >=, with the equals sign last'),
    Case(
        pattern=rf'{_AT}(?:&&|\|\||!\s*[\w(])',
        to_do=', so write the words `and`, `or` and `not`',
    ),
    Case(pattern=rf'{_AT}(?:\+\+|--)', to_do=', so write += 1 or -= 1 to count'),
    Case(
        pattern=r'SyntaxError: [^(]*\(line \d+: else if ',
        to_do=', so write elif in place of else if',
    ),
    Case(
        pattern='IndentationError: expected an indented block',
        to_do=', so begin the lines of that block with four more spaces; a block without a '
        'statement needs the word pass',
    ),
    Case(
        pattern='(?:IndentationError|TabError): ',
        to_do=', so let all lines of a block begin with equally many spaces',
    ),
)
