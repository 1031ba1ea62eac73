"""A real Chromium, for the tests that drive one."""

import shutil
from contextlib import ExitStack, contextmanager

import pytest
from playwright.sync_api import expect, sync_playwright

PROGRAM = next(filter(None, map(shutil.which, ['chromium', 'chromium-browser'])), None)
LONG = 120_000
"""Milliseconds that a slow machine may need for any step; tests do not measure time with it."""
expect.set_options(timeout=LONG)

drives_chromium = [
    pytest.mark.browser,
    pytest.mark.skipif(PROGRAM is None, reason='no chromium here: .ci/run installs it'),
]


@contextmanager
def launched():
    """Yield a browser, which is closed at the end of the block."""
    with several_launched(1) as (browser,):
        yield browser


@contextmanager
def several_launched(number):
    """Yield several browsers, each a separate process, closed at the end of the block."""
    with sync_playwright() as playwright, ExitStack() as stack:
        chromium = playwright.chromium
        browsers = []
        for _ in range(number):
            browser = chromium.launch(executable_path=PROGRAM, args=['--no-sandbox'])
            stack.callback(browser.close)
            browsers.append(browser)
        yield browsers
