"""Say in a cell that a constructor does not return, and at which line it is.

A node that waits in `__init__` for a service, as many examples do, keeps its cell busy without
any output: its log appears only once the node runs.
"""

import contextlib
import threading
from collections.abc import Iterator

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.output import notebook, troubles
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import in_lines

LATE_SEC = 5.0
"""Constructors only create things; a busy machine may need some seconds for that."""


@contextlib.contextmanager
def told(class_name: str) -> Iterator[None]:
    """Tell it in the cell that runs now if the block takes longer; the text goes if it ends."""
    if not notebook.in_kernel() or classroom.in_grading_room():
        yield
        return
    display, thread_id = notebook.Display(), threading.get_ident()

    def tell() -> None:
        line = in_language_here(troubles.line_in_thread(thread_id))
        said = in_language_here(
            f'the constructor of {class_name} has not returned for {LATE_SEC:g} s. Until it does, '
            'the node does not run, nor does another cell: press ■ (Interrupt the kernel) above, '
            'and leave out of __init__ what waits or loops.'
        )
        text = '\n'.join([*in_lines(said), *([f'  {line}'] if line else [])])
        display.show({})  # empty: tools that compare two runs see only this first state
        display.update({'text/plain': text})

    timer = threading.Timer(LATE_SEC, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
    timer.join()  # else the text could appear after this
    display.update({})
