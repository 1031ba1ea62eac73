"""Makes empty files until there is no room for more."""

import contextlib
import itertools

with contextlib.suppress(OSError):
    for number in itertools.count():
        open(f'/tmp/{number}', 'w').close()
