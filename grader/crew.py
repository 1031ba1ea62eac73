"""Whoever grades: the worker processes of this machine, or those of a cluster."""

from concurrent.futures import Future
from typing import Protocol, Self

from grader.task import Result, Task


class Crew(Protocol):
    """Takes tasks inside its `with`; what is not done when that is left is called off."""

    room: int
    """How many submissions it works on at a time."""

    def __enter__(self) -> Self:
        """Begin to take tasks."""
        ...

    def __exit__(self, *exception: object) -> None:
        """End what still runs."""
        ...

    def isolated(self, *, trust_students: bool) -> bool:
        """Return whether student code runs in a sandbox; raises CourseError where it must."""
        ...

    def submit(self, task: Task) -> 'Future[Result]':
        """Grade a task as soon as there is room. The future raises TaskFailed for no result."""
        ...
