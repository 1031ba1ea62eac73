"""A ROS package that a student has submitted: whether it was built, and what its nodes do."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.packages.package_processes import RunningExecutable
from my_robot_basics.checks.packages.package_words import text_in
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.hidden import student_text

MOST_REASON = 400
"""How many characters of an error to show: enough for a path, a line of Python, and a hint."""


def package(name: str) -> 'Package':
    """The package in the folder of that name beside the notebook.

    A locked cell of the exercise must have called `build_package(name)`. Raises nothing.
    """
    return Package(name)


@dataclass(frozen=True)
class Package:
    """The assertions of a check about a package."""

    name: str

    def expect_built(self, *, executables: Sequence[str] = ()) -> None:
        """Colcon has built the package, and `ros2 run` finds these executables in it.

        Raises CheckFailed with what is wrong: a missing file, a line of setup.py, or a module that
        entry_points name but that does not exist.
        """
        told = student.ask_package(self.name, 'built')
        if told.get('found') is not True:
            fail(
                expected=f'{self.name} to be built',
                seen='no build',
                hint=f"run the cell with build_package('{self.name}')",
                cause=f'{self.name} was not built',
            )
        status, problem = told.get('status'), text_in(told, 'problem')
        if status != 0 or type(status) is not int or problem:
            fail(
                expected=f'{self.name} to be built, and its executables to be found',
                seen=_how_it_went(status),
                hint=student_text(shorten(problem, MOST_REASON)) or 'read what colcon prints',
                cause=f'{self.name} is not built as it is',
            )
        listed = told.get('executables')
        there = [each for each in listed if isinstance(each, str)] if type(listed) is list else []
        if missing := [each for each in executables if each not in there]:
            fail(
                expected=f'the executables {", ".join(executables)} in {self.name}',
                seen=student_text(shorten(', '.join(there))) or 'none',
                hint=f'name {", ".join(missing)} in entry_points of setup.py',
                cause=f'{self.name} has no executable {", ".join(missing)}',
            )

    def run(
        self,
        executable: str,
        *arguments: str,
        parameters: Mapping[str, Any] | None = None,
        rules: Mapping[str, str] | None = None,
    ) -> RunningExecutable:
        """Start an executable as `ros2 run` does, in the student's room, until the `with` ends.

        `parameters` become `-p name:=value`. `rules` are remap rules, such as `{'__ns': '/left'}`.
        Processes that the student started from the package with `run_executable` end first.
        """
        words = [*arguments]
        if parameters or rules:
            words += ['--ros-args']
        for name, value in (parameters or {}).items():
            words += ['-p', f'{name}:={_as_yaml(value)}']
        for left, right in (rules or {}).items():
            words += ['-r', f'{left}:={right}']
        return RunningExecutable(self.name, executable, tuple(words))


def _how_it_went(status: object) -> str:
    if type(status) is not int:
        return 'no build'
    return f"colcon's exit code {status}" if status else 'a build that `ros2 run` cannot use'


def _as_yaml(value: Any) -> str:
    """A value as rcl's parameter parser reads it. Raises TypeError for an unsupported type."""
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return '"' + value.replace('\\', '\\\\').replace('"', '\\"') + '"'
    if isinstance(value, list | tuple):
        return f'[{", ".join(map(_as_yaml, value))}]'
    raise TypeError(f'a parameter is a bool, a number, a text or a list of these, not {value!r}')
