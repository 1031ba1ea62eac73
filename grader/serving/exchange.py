"""Release feedback pages where nbgrader's `fetch_feedback` and Assignment List look for them."""

import os
from pathlib import Path

from nbgrader.utils import notebook_hash

FOLDER_MODE, PAGE_MODE = 0o711, 0o644
"""Other users can't list the folder; a page's name is known only to its student."""


def feedback_folder(inbound: Path) -> Path | None:
    """Return the exchange's feedback folder, if `inbound` is an exchange's inbound folder."""
    inbound = inbound.resolve()
    is_exchange = inbound.name == 'inbound' and (inbound.parent / 'outbound').is_dir()
    return inbound.parent / 'feedback' if is_exchange else None


def release_page(page: Path, folder: Path, *, secret: str, notebook: str) -> Path:
    """Put a feedback page into the exchange atomically; return its path."""
    if not folder.is_dir():
        folder.mkdir()
        folder.chmod(FOLDER_MODE)
    place = folder / f'{notebook_hash(secret=secret, notebook_id=notebook)}.html'
    aside = place.with_name(f'.{place.name}.new')
    with aside.open('wb') as file:
        file.write(page.read_bytes())
        file.flush()
        os.fchmod(file.fileno(), PAGE_MODE)
        os.fsync(file.fileno())
    os.replace(aside, place)
    return place
