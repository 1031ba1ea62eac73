"""Outputs of a kernel made safe to store: of known kinds, bounded, and valid Unicode."""

import nbformat
from nbformat import NotebookNode

from my_robot_basics.validate.kernels.pictures import KINDS, why_not_shown

MAX_ALT_CHARACTERS = 500
MAX_ERROR_CHARACTERS = 10_000
WIDGET_VIEW = 'application/vnd.jupyter.widget-view+json'
"""It is useless without its kernel, and if it is text, it crashes programs that show it."""


def safe_output(kind: str, content: dict) -> NotebookNode | None:
    """Return an output that is safe to store; None if the message is not a valid output."""
    match kind, content:
        case 'stream', {'name': 'stdout' | 'stderr' as name, 'text': str(text)}:
            return nbformat.v4.new_output('stream', name=name, text=_clean(text))
        case 'display_data' | 'execute_result', {'data': dict(data)}:
            texts = {mime: text for mime, text in data.items() if isinstance(text, str)}
            data = {_clean(m): _clean(text) for m, text in texts.items() if m != WIDGET_VIEW}
            about = _about_pictures(content.get('metadata'), data)
            _leave_large_pictures_out(data)
            return nbformat.v4.new_output(kind, data=data, metadata=about)
        case 'error', {'ename': str(name), 'evalue': str(value), 'traceback': list(lines)}:
            return nbformat.v4.new_output(
                'error',
                ename=_clean(name)[:200],
                evalue=_clean(value)[:MAX_ERROR_CHARACTERS],
                traceback=_clean('\n'.join(map(str, lines)))[-MAX_ERROR_CHARACTERS:].split('\n'),
            )
    return None


def _leave_large_pictures_out(data: dict[str, str]) -> None:
    for kind in KINDS:
        if kind in data and (why := why_not_shown(data[kind])):
            del data[kind]
            data['text/plain'] = f'[{why} was left out]'


def _about_pictures(metadata: object, data: dict[str, str]) -> dict[str, dict[str, int | str]]:
    """Keep the width and height (pixels) of pictures and their alternative text, by MIME type.

    Other metadata is dropped: a million invented MIME types would be a million objects.
    """
    kept = {}
    for kind in KINDS:
        about = metadata.get(kind) if isinstance(metadata, dict) else None
        if kind in data and isinstance(about, dict):
            kept[kind] = {k: about[k] for k in ('width', 'height') if type(about.get(k)) is int}
            if isinstance(about.get('alt'), str):
                kept[kind]['alt'] = _clean(about['alt'])[:MAX_ALT_CHARACTERS]
    return kept


def _clean(text: str) -> str:
    """Replace lone surrogates, which can't be encoded as UTF-8."""
    return text.encode(errors='replace').decode()
