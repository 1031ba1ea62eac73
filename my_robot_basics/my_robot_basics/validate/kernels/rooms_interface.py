"""The interface of two rooms that judging needs, for the grader's rooms and *Validate*'s."""

from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from typing import Protocol, TypeVar

from my_robot_basics.validate.kernels.outputs import CellRun


class Rooms(Protocol):
    """Two kernels that share nothing but a ROS domain: the student's and the test's."""

    @property
    def student_alive(self) -> bool:
        """Whether the student's kernel still runs."""

    async def run_student_cell(self, source: str, *, timeout_sec: float) -> CellRun:
        """Run one of the student's cells."""

    def student_cpu_sec(self) -> float | None:
        """Return the processor time of the student's room in seconds; None if not measured."""

    async def run_check(self, source: str) -> CellRun:
        """Run a grade cell, and pass its requests on to the student's kernel."""


R = TypeVar('R', bound=Rooms)

OpenRooms = Callable[[], AbstractAsyncContextManager[R]]
