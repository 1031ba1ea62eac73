"""axe-core finds no serious fault in the pages that students read."""

from datetime import datetime

import nbformat
import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import drives_chromium, launched
from nbconvert import HTMLExporter
from sample_class import PATHS, assignment_of, grade

from grader.course import ROOT, Course
from grader.report.feedback import write_feedback
from grader.report.report import Run, write_report

RELEASED = ROOT / 'notebooks'
LESSONS = sorted(
    path
    for path in RELEASED.glob('**/*.ipynb')
    if path.parent.name != '.ipynb_checkpoints'  # of JupyterLab
)
OF_THE_THEME = ['.jp-InputPrompt', '.jp-OutputPrompt', '.highlight']
"""Parts whose colours Jupyter chooses: the numbers of cells, and the code."""
LINKS_OF_THE_THEME = {'link-in-text-block': {'enabled': False}}
"""Jupyter chooses, too, that links in a notebook are not underlined."""
NO_WORDS = 'No description has been provided for this image'
"""The text that nbconvert gives a picture without alternative text."""

pytestmark = drives_chromium


@pytest.fixture(scope='module')
def browser():
    with launched() as browser:
        yield browser


@pytest.fixture(scope='module')
def page(browser):
    return browser.new_page(bypass_csp=True)


@pytest.fixture(scope='module')
def dark_phone(browser):
    return browser.new_page(
        bypass_csp=True, color_scheme='dark', viewport={'width': 400, 'height': 800}
    )


def serious(page, html):
    """Rule and element of each finding that keeps somebody from reading the page."""
    page.set_content(html)
    found = (
        Axe()
        .run(
            page,
            context={'exclude': [[name] for name in OF_THE_THEME]},
            options={'rules': LINKS_OF_THE_THEME},
        )
        .response
    )
    return [
        (rule['id'], node['html'], node['failureSummary'])
        for rule in found['violations']
        if rule['impact'] in ('serious', 'critical')
        for node in rule['nodes']
    ]


def cut_off(page):
    """The cells of tables, and paragraphs, that extend beyond the right edge of the screen."""
    return page.evaluate(
        """Array.from(document.querySelectorAll('tbody th, tbody td, p, dd'))
        .filter(each => each.getBoundingClientRect().right > window.innerWidth)
        .map(each => each.textContent)"""
    )


def scrolls_sideways(page):
    """The parts that need sideways scrolling: the page itself, or a table."""
    return page.evaluate(
        """Array.from(document.querySelectorAll('html, .wide'))
        .filter(each => each.scrollWidth > each.clientWidth)
        .map(each => each.ariaLabel || each.tagName)"""
    )


def broken_code(page):
    """The answers with a line that is shown as several: its indentation seems to be another."""
    return page.evaluate(
        """Array.from(document.querySelectorAll('section > pre code')).filter(each => {
            const lines = Array.from(each.getClientRects()).map(line => Math.round(line.top));
            return new Set(lines).size > each.textContent.split('\\n').length;
        }).map(each => each.textContent)"""
    )


@pytest.mark.slow
def test_axe_finds_an_image_without_alternative_text(page):
    # or the tests below would find nothing in anything
    html = '<html lang="en"><title>Arm</title><main><h1>Arm</h1><img src="arm.png"></main></html>'
    assert [rule for rule, *_ in serious(page, html)] == ['image-alt']


@pytest.mark.parametrize('path', LESSONS, ids=lambda p: str(p.relative_to(RELEASED)))
def test_a_released_lesson_is_accessible(page, path):
    html, _ = HTMLExporter().from_notebook_node(nbformat.read(path, as_version=4))
    assert serious(page, html) == []
    assert NO_WORDS not in html


@pytest.mark.slow
@pytest.mark.parametrize('name', ['03_publisher-fail-1hz', '03_publisher-zero-not_json'])
def test_feedback_and_the_report_of_a_run_are_accessible(page, dark_phone, tmp_path, name):
    course = Course(gradebook=tmp_path)
    rows = grade(course, [name])
    write_feedback(course)
    assignment = assignment_of(PATHS[name])
    html = (course.folder('feedback', name, assignment) / f'{assignment}.html').read_text()
    assert ('<img' in html) == ('fail' in name)
    assert serious(page, html) == []
    assert serious(dark_phone, html) == []
    assert cut_off(dark_phone) == []
    assert scrolls_sideways(dark_phone) == []
    assert broken_code(dark_phone) == []
    background = "getComputedStyle(document.querySelector('section')).backgroundColor"
    assert dark_phone.evaluate(background) != page.evaluate(background)
    report = write_report(course, Run(datetime.now().astimezone()), list(rows.values()))
    assert serious(page, report.read_text(encoding='utf-8')) == []
    assert serious(dark_phone, report.read_text(encoding='utf-8')) == []
    assert cut_off(dark_phone) == []
    assert scrolls_sideways(dark_phone) == []
