"""What a student reads instead of a check's failure as long as the exercise is not answered."""

import re

PLACEHOLDER = re.compile('YOUR CODE HERE')
"""What a released answer cell has in place of the answer. A cell without it holds code to fix:
there, the failure of a check is a part of the exercise."""


def say_unanswered(name: str) -> tuple[str, str]:
    """Return the sentence for an exercise of that name, and the hint at its end."""
    hint = f'write it into the answer cell `{name}`, where it says YOUR CODE HERE'
    return f'expected an answer to `{name}`, saw none yet: {hint}', hint
