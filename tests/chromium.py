"""A real Chromium, for the tests that drive one."""

import shutil
from contextlib import contextmanager

import pytest
from playwright.sync_api import expect, sync_playwright

PROGRAM = next(filter(None, map(shutil.which, ['chromium', 'chromium-browser'])), None)
LONG = 120_000
"""Milliseconds: what a slow machine may need for anything here; nothing is judged by it."""
expect.set_options(timeout=LONG)

drives_chromium = [
    pytest.mark.browser,
    pytest.mark.skipif(PROGRAM is None, reason='no chromium here: .ci/run installs it'),
]


@contextmanager
def launched():
    """Yield a browser, which ends with the `with`."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=PROGRAM, args=['--no-sandbox'])
        yield browser
        browser.close()
