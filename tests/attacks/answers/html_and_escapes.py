"""Puts HTML, JavaScript, terminal escapes and odd letters into its outputs."""

from IPython.display import HTML, Javascript, Markdown, display

evil = '<script>alert(document.domain)</script><img src=x onerror=alert(1)>'
display(HTML(evil), Javascript('alert(1)'), Markdown(evil))
display({'image/svg+xml': f'<svg xmlns="http://www.w3.org/2000/svg">{evil}</svg>'}, raw=True)
print('\x1b[2J\x1b]0;title\x07\u202e', evil)
raise ValueError(evil)
