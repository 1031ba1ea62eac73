"""How busy the machine is, as Linux tells it."""

import re
from pathlib import Path

CPU = Path('/proc/pressure/cpu')


def crowded_sec() -> float:
    """For how long so far some process had to wait for a processor, in seconds.

    Only differences mean anything. 0.0 where Linux does not tell (psi=0).
    """
    try:
        text = CPU.read_text(encoding='ascii')
    except OSError:
        return 0.0
    return int(re.search(r'^some .*total=(\d+)', text)[1]) / 1e6
