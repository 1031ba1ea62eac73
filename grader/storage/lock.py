"""One at a time: the lock that keeps `nbgrader autograde` and `./course grade` apart."""

import fcntl
import os
import weakref
from collections.abc import Callable
from pathlib import Path

from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode

from grader.course import Course


class Turn:
    """The right to write into a gradebook, until `end` or until nobody refers to it any more."""

    _taken: weakref.WeakValueDictionary = weakref.WeakValueDictionary()

    def __init__(self, path: Path, say: Callable[[str], None]) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        self.end = weakref.finalize(self, os.close, handle)
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                say(f'waiting: process {_text(handle)} is grading into {path.parent}')
                fcntl.flock(handle, fcntl.LOCK_EX)
            os.ftruncate(handle, 0)
            os.pwrite(handle, str(os.getpid()).encode(), 0)
        except BaseException:
            self.end()  # an error that is kept would keep the lock with it
            raise

    @classmethod
    def take(cls, gradebook: Path, say: Callable[[str], None] = print) -> 'Turn':
        """Wait for the gradebook to be free, and say so if that takes waiting.

        A process that has its turn already gets the same one again: it would wait for itself.
        """
        path = gradebook.resolve() / '.lock'
        turn = cls._taken.get(path)
        if turn is None or not turn.end.alive:
            turn = cls._taken[path] = cls(path, say)
        return turn

    def __enter__(self) -> 'Turn':
        """Hold the turn for the block."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Give the turn back."""
        self.end()


class TakeTurns(Preprocessor):
    """Hold the turn while nbgrader converts and writes one notebook.

    It ends with the resources of that conversion, however the conversion ends.
    """

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Wait for the turn; change nothing."""
        course = Course.of_nbgrader(resources)
        resources['my_robot_basics_turn'] = Turn.take(course.gradebook, self.log.warning)
        return nb, resources


def _text(handle: int) -> str:
    return os.pread(handle, 20, 0).decode(errors='replace') or 'unknown'
