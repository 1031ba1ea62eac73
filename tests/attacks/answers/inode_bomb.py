"""Makes empty files until there is no room for more."""

import itertools

for number in itertools.count():
    try:
        open(f'/tmp/{number}', 'w').close()
    except OSError:
        pass
