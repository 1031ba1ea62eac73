"""Waiting for what the doctor is to find: processes come up when they do."""

import time

TIMEOUT_SEC = 20.0
"""How long a node may take to come up, to ask or to answer, on a busy machine."""


def wait_for(done):
    """Wait until something is so; return whether it is."""
    deadline = time.monotonic() + TIMEOUT_SEC
    while not done() and time.monotonic() < deadline:
        time.sleep(0.02)
    return done()


def wait_for_finding(first_finding, title, **options):
    """Return the first finding, once that is the one with a title."""
    deadline = time.monotonic() + TIMEOUT_SEC
    while (found := first_finding(**options)).title != title and time.monotonic() < deadline:
        pass
    assert found.title == title
    return found
