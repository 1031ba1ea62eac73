"""The HTML that the formgrader shows is made in a process with limits."""

import re

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
    options = {
        'HTMLExporter': {'filters': formgrader.FILTERS, 'sanitize_html': True},
        'NbConvertBase': {'display_data_priority': formgrader.OUTPUT_KINDS},
    }
    exporter = HTMLExporter(config=Config(options))
    return exporter.from_notebook_node(nbformat.v4.new_notebook(cells=list(cells)))[0]


def test_text_code_and_output_are_rendered_without_scripts():
    code = nbformat.v4.new_code_cell('def f():\n    pass')
    data = {'text/html': '<a href="/user/eve">x</a>', 'text/plain': '<b>as text</b>'}
    code.outputs = [nbformat.v4.new_output('display_data', data=data)]
    text = nbformat.v4.new_markdown_cell('*so* `it` is: $x^2$ ![a](attachment:a.png)')
    text.attachments = {'a.png': {'image/png': 'aGVsbG8='}}
    html = shown(text, code)
    assert '<em>so</em> <code>it</code> is: $x^2$' in html
    assert 'src="data:image/png;base64,aGVsbG8="' in html
    assert '<span class="k">def</span>' in html
    assert '&lt;b&gt;as text&lt;/b&gt;' in html
    assert '/user/eve' not in html


@pytest.mark.parametrize('kind', ['text/html', 'text/latex', 'text/markdown', 'image/svg+xml'])
def test_only_text_and_pictures_are_shown_of_an_output(kind):
    data = {kind: 'it leads elsewhere'}
    output = nbformat.v4.new_output('display_data', data=data)
    with pytest.warns(UserWarning, match='not able to be represented'):
        html = shown(nbformat.v4.new_code_cell('x = 1', outputs=[output]))
    assert 'it leads elsewhere' not in html


HIDDEN = 'a\u202eb\u200bc'
SHOWN = r'a\u202eb\u200bc'


def test_characters_that_conceal_text_are_spelled_out_in_all_that_a_student_wrote():
    text = nbformat.v4.new_markdown_cell(f'{HIDDEN} &#x202e; &rlm; 👩\u200d🔬\n\n<p>&#8238;</p>')
    outputs = [
        nbformat.v4.new_output('stream', text=HIDDEN),
        nbformat.v4.new_output('display_data', data={'text/plain': HIDDEN}),
        nbformat.v4.new_output('error', ename='E', evalue=HIDDEN, traceback=[HIDDEN]),
    ]
    html = shown(text, nbformat.v4.new_code_cell(f'# {HIDDEN}', outputs=outputs))
    assert not re.search('[\u200b\u200f\u202a-\u202e]|&#x202e;|&#8238;|&rlm;', html)
    assert html.count(SHOWN) == 5
    assert '👩\u200d🔬' in html


LINKS = {
    '[plot](/user/eve/plot?a=1&b=2)': 'plot (/user/eve/plot?a=1&amp;b=2)',
    '<a href="https://a.b/&#x202e;c">plot</a>': r'plot (https://a.b/\u202ec)',
    '<a href=" da&#10;ta:text/html,x">plot</a>': 'plot ( da\nta:text/html,x)',
    '<a href="java&#10;script:x">plot</a>': 'plot',
    '<a>plot</a>': 'plot',
}


@pytest.mark.parametrize('link', LINKS)
def test_a_link_is_shown_with_its_address_and_leads_nowhere(link):
    """On a hub it might lead to the student's server, whose pages may do what the reader may."""
    assert formgrader.render_markdown(link, {}) == f'<p><a>{LINKS[link]}</a></p>\n'


FORMULAS_WITH_A_LINK = (r'$\href{/user/eve}{x}$', r'$\mmlToken{mi}[href="/user/eve"]{x}$')
FORMULAS_WITH_A_LINK += (r'<p>$\&#104;ref{/user/eve}{x}$</p>', r'<p>$\<!-- -->href{/a}{x}$</p>')


@pytest.mark.parametrize('formula', FORMULAS_WITH_A_LINK)
def test_a_formula_that_would_become_a_link_is_not_typeset(formula):
    html = formgrader.render_markdown(formula, {})
    assert html.startswith('<div class="tex2jax_ignore"><p>$')
    assert formgrader.render_markdown('$x^2$', {}) == '<p>$x^2$</p>\n'


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
