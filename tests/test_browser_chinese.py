"""The Chinese edition as its students see it: JupyterLab of `./course lab --language zh_CN`."""

import re
import shutil

import pytest
from chromium import LONG, drives_chromium, launched
from lab_browser import (
    ALL_RAN,
    LESSONS,
    ROOT,
    TOKEN,
    Lab,
    Lesson,
    close_all,
    errors,
    run_through,
    wait_until_open,
    warnings,
)
from playwright.sync_api import expect

pytestmark = [*drives_chromium, pytest.mark.slow]  # the English edition has the same driver

LANGUAGE = 'zh_CN'
QUIZZES = sorted(path.name for path in ROOT.glob('notebooks/quiz_*.ipynb'))
PAGES = ('terms.md', 'what_next.md')
CHINESE = re.compile(r'[\u3400-\u9fff]')
ENGLISH = re.compile(r"[A-Za-z][a-z']+(?:[ ,:;]+[A-Za-z][a-z']*){3,}")
"""Four Latin words in a row: more than a name."""
RAW = re.compile(r'\*\*|`|\]\(|(?<![\w*])\*(?=[^\s*])')
"""Markdown that is shown as it is written."""
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
    check_blocks(list(blocks(lesson)))


def check_blocks(shown):
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


def printed(lesson):
    """What the cells of a lesson have printed, line by line."""
    outputs = (output for cell in lesson.cells for output in cell.get('outputs', []))
    texts = (output.text for output in outputs if output.output_type == 'stream')
    return [line for text in texts for line in text.splitlines()]


@pytest.mark.parametrize('name', QUIZZES)
def test_each_chinese_quiz_asks_and_answers_in_chinese(page, name):
    close_all(page)
    lesson = Lesson(page, f'{LANGUAGE}/{name}')
    check_text(lesson)
    asked = [cell for cell in lesson.cells if 'guess=...' in cell.source]
    assert len(asked) == 10
    first = asked[0]
    lesson.type(first.id, first.source.replace('guess=...', "guess='no'"))
    lesson.command('notebook:run-all-cells')
    page.wait_for_function(ALL_RAN, timeout=3 * LONG)
    assert errors(lesson.cells) == {}
    assert warnings(lesson.cells) == []
    said = printed(lesson)
    assert sum(line.startswith('把你的猜测写在') for line in said) == len(asked) - 1
    assert [line for line in said if line.startswith("你猜的是 'no'，而结果是")]
    assert [line for line in said if not CHINESE.search(line) and ENGLISH.search(line)] == []


@pytest.mark.parametrize('name', PAGES)
def test_each_page_beside_the_lessons_is_shown_in_chinese(page, name):
    close_all(page)
    opened = f'{LANGUAGE}/{name}'
    open_path = "async path => { await jupyterapp.commands.execute('docmanager:open', {path}) }"
    page.evaluate(open_path, opened)
    shown = page.locator('.jp-MarkdownViewer:visible .jp-RenderedMarkdown')
    expect(shown.locator('h1')).to_contain_text(CHINESE)
    check_blocks(shown.evaluate(BLOCKS))
