"""The HTML that the formgrader shows is made in a process with limits."""

import nbformat
import pytest
from nbconvert import HTMLExporter
from traitlets.config import Config

from grader.common.parsing import Limits
from grader.report import formgrader

FORMULAS = r'\begin{a}' * 40_000
"""For each of these formulas, the rest of the text is searched for its end."""


def shown(*cells):
    """Return the HTML of cells, from the exporter that nbgrader_config.py sets up."""
    options = {'filters': formgrader.FILTERS, 'sanitize_html': True}
    exporter = HTMLExporter(config=Config({'HTMLExporter': options}))
    return exporter.from_notebook_node(nbformat.v4.new_notebook(cells=list(cells)))[0]


def test_text_code_and_output_are_rendered_without_scripts():
    code = nbformat.v4.new_code_cell('def f():\n    pass')
    data = {'text/html': '<b onclick="x()">bold</b><script>x()</script>'}
    code.outputs = [nbformat.v4.new_output('display_data', data=data)]
    text = nbformat.v4.new_markdown_cell('*so* `it` is: $x^2$ ![a](attachment:a.png)')
    text.attachments = {'a.png': {'image/png': 'aGVsbG8='}}
    html = shown(text, code)
    assert '<em>so</em> <code>it</code> is: $x^2$' in html
    assert 'src="data:image/png;base64,aGVsbG8="' in html
    assert '<span class="k">def</span>' in html
    assert '<b>bold</b>' in html
    assert 'onclick' not in html


WRITTEN = ('data:', 'DATA:', ' data:', '\tdata:', 'da&#9;ta:', 'da&#10;ta:', '&#1;data:')
WRITTEN += ('&#100;ata:', 'data&colon;', 'data&#x3a;', 'javascript:', 'java&#10;script:')


@pytest.mark.parametrize('written', WRITTEN)
def test_a_link_leads_to_no_page_that_is_in_the_link_itself(written):
    html = formgrader.render_markdown(f'<a href="{written}text/html,x">open</a>', {})
    assert html == '<p><a>open</a></p>\n'


def test_a_link_to_a_page_elsewhere_is_kept():
    html = formgrader.render_markdown('[one](https://docs.ros.org/data:x) [two](#below)', {})
    assert '<a href="https://docs.ros.org/data:x">one</a> <a href="#below">two</a>' in html


@pytest.mark.slow
@pytest.mark.parametrize(
    'text', [FORMULAS, '<a ' * 60_000, '![a](files/' * 60_000], ids=['math', 'tags', 'files']
)
def test_text_that_takes_too_long_to_convert_is_shown_as_typed(text, monkeypatch):
    monkeypatch.setattr(formgrader, 'LIMITS', Limits(cpu_sec=1))
    output = nbformat.v4.new_output('display_data', data={'text/html': text})
    html = shown(
        nbformat.v4.new_markdown_cell(text),
        nbformat.v4.new_code_cell('x = 1', outputs=[output]),
        nbformat.v4.new_markdown_cell('*next*'),
    )
    assert 'Shown as it was typed: it takes over 1 s of processor time.' in html
    assert '<em>next</em>' in html
    assert '<a <a' not in html


def test_code_that_submissions_share_is_highlighted_only_once(monkeypatch):
    asked = []
    monkeypatch.setattr(formgrader, 'parse', lambda *args, limits: asked.append(args) or 'x')
    for _ in range(3):
        formgrader.highlight_code('this_is_asked_once = 1')
    assert len(asked) == 1
