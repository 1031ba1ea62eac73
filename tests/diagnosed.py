"""Wait for what the doctor has to find: processes need time to start."""

import time

TIMEOUT_SEC = 20.0
"""How long a node may take to start, to call or to answer, on a busy machine."""


def wait_for(done):
    """Wait until a condition is true; return whether it is."""
    deadline = time.monotonic() + TIMEOUT_SEC
    while not done() and time.monotonic() < deadline:
        time.sleep(0.02)
    return done()


def wait_for_finding(first_finding, title, **options):
    """Return the first finding when it has this title."""
    deadline = time.monotonic() + TIMEOUT_SEC
    while (found := first_finding(**options)).title != title and time.monotonic() < deadline:
        pass
    assert found.title == title
    return found
