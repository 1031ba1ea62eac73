"""The Chinese edition as its students see it: JupyterLab of `./course lab --language zh_CN`."""

import re
import shutil

import pytest
from chromium import LONG, drives_chromium, launched
from playwright.sync_api import expect
from test_browser import LESSONS, ROOT, TOKEN, Lab, Lesson, close_all, run_through, wait_until_open

pytestmark = [*drives_chromium, pytest.mark.slow]  # the English edition has the same driver

LANGUAGE = 'zh_CN'
CHINESE = re.compile(r'[\u3400-\u9fff]')
ENGLISH = re.compile(r"[A-Za-z][a-z']+(?:[ ,:;]+[A-Za-z][a-z']*){3,}")
"""Four Latin words, one behind the other: no name."""
RAW = re.compile(r'\*\*|`|\]\(|(?<![\w*])\*(?=[^\s*])')
"""Markdown that was not understood."""
BLOCKS = """text => {
    const copy = text.cloneNode(true);
    copy.querySelectorAll('code, pre, a[href^="http"]').forEach(each => each.remove());
    const blocks = copy.querySelectorAll('h1, h2, h3, p, li, th, td');
    return [...blocks].map(block => block.innerText || block.textContent);
}"""


@pytest.fixture(scope='module')
def page(tmp_path_factory):
    """The browser on the contents page, as the command has opened it."""
    lab = Lab(tmp_path_factory.mktemp('lab'), '--language', LANGUAGE)
    try:
        shutil.copytree(ROOT / 'notebooks', lab.folder, dirs_exist_ok=True, symlinks=True)
        lab.wait_until_up()
        with launched() as browser:
            page = browser.new_page(viewport={'width': 1200, 'height': 900}, locale='zh-CN')
            page.set_default_timeout(LONG)
            page.goto(f'{lab.address}/?token={TOKEN}')
            page.wait_for_function('window.jupyterapp?.restored.then(() => true)')
            wait_until_open(page, f'{LANGUAGE}/index.ipynb')
            yield page
    finally:
        lab.stop()


def blocks(lesson):
    """The words of each block of text, as the browser shows them, without code."""
    for cell in lesson.cells:
        if cell.cell_type == 'markdown':
            shown = lesson.shown(cell.id).locator('.jp-RenderedMarkdown')
            yield from shown.evaluate(BLOCKS)


def check_text(lesson):
    shown = list(blocks(lesson))
    words = [block for block in shown if re.search(r'[^\W\d_]', block)]
    assert sum(bool(CHINESE.search(block)) for block in words) > 0.8 * len(words)
    assert [block for block in shown if RAW.search(block)] == []
    english = [each for each in shown if not CHINESE.search(each) and ENGLISH.search(each)]
    assert english == []


def test_the_chinese_contents_lead_to_every_lesson_in_a_chinese_jupyterlab(page):
    expect(page.locator('.lm-MenuBar-itemLabel').first).to_contain_text('文件')
    lesson = Lesson(page, f'{LANGUAGE}/index.ipynb')
    check_text(lesson)
    for name in LESSONS:
        links = page.locator(f'.jp-RenderedMarkdown a[href*="{name}.ipynb"]')
        assert CHINESE.search(links.first.inner_text()), name


@pytest.mark.parametrize('name', LESSONS)
def test_each_chinese_lesson_runs_in_a_browser(page, name):
    close_all(page)
    lesson = Lesson(page, f'{LANGUAGE}/{name}/{name}.ipynb')
    check_text(lesson)
    run_through(lesson)
