"""Write the reference of what lessons and checks call, from their docstrings.

.venv/bin/python -P docs/build_reference.py [FOLDER]

FOLDER is docs/reference/ unless another is named; open its index.html in a browser.
"""

import sys
from importlib import import_module
from pathlib import Path

import pdoc

PAGES = ('my_robot_basics.checks', 'my_robot_basics.live')
CALLED = 'my_robot_basics.exchange.student', 'my_robot_basics.checks.values.joints'
"""Modules of which grade cells call the functions: a page of its own for each."""
OTHERS = rf'!my_robot_basics\.(?:checks|live)\.(?!{CALLED[1].partition(".checks.")[2]}$)'
"""The modules that hold all this, and much that is no one else's business."""


def build(folder: Path) -> None:
    """Write the pages into a folder, which is made where it is missing."""
    for name in PAGES:
        page = import_module(name)
        for public in page.__all__:  # they are imported on demand, and pdoc looks at what is there
            setattr(page, public, getattr(page, public))
    pdoc.render.configure(show_source=False)
    pdoc.pdoc(*PAGES, *CALLED, OTHERS, output_directory=folder)


if __name__ == '__main__':
    given = sys.argv[1:] or [str(Path(__file__).with_name('reference'))]
    build(Path(*given))
    print(f'{given[0]}/index.html')
