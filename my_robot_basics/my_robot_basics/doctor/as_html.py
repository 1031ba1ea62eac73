"""A diagnosis as HTML, whose lines adapt to the width of the page."""

import html

from my_robot_basics.doctor.evidence import Diagnosis, Finding
from my_robot_basics.doctor.report import fields, first_sentence
from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.speaking import in_language

STYLE = 'font-size:13px;line-height:1.4;overflow-wrap:anywhere'
"""The text size of other outputs; long words are broken in a narrow window."""
CODE_STYLE = 'margin:2px 0;white-space:pre-wrap;overflow-wrap:anywhere'


def tell_as_html(diagnosis: Diagnosis, language: str = ENGLISH) -> str:
    """Return the whole diagnosis as HTML, with the words of `report.tell`."""
    items = ''.join(_item(finding, language) for finding in diagnosis.findings)
    first = f'<p>{html.escape(first_sentence(diagnosis, language))}</p>'
    shown = f'{first}\n<ol>\n{items}</ol>' if items else first
    return f'<div style="{STYLE}">{shown}</div>'


def _item(finding: Finding, language: str) -> str:
    lines = [f'<b>{html.escape(in_language(language, finding.title))}</b>']
    for label, text in fields(finding, language).items():
        lines.append(f'<br>\n<i>{html.escape(label)}</i> {html.escape(text)}')
    if finding.code:
        lines.append(f'\n<pre style="{CODE_STYLE}">{html.escape(finding.code)}</pre>')
    return f'<li>{"".join(lines)}</li>\n'
