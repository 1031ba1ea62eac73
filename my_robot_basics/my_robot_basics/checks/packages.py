"""A ROS package that a student has handed in: was it built, and what do its executables do?"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.package_processes import RunningExecutable
from my_robot_basics.checks.package_words import text_in
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.hidden import theirs

MOST_REASON = 400
"""Characters of what is wrong with a package: a path, a line of Python, and what to do."""


def package(name: str) -> 'Package':
    """The package in the folder of that name beside the notebook.

    A locked cell of the exercise calls `build_package(name)`. Raises nothing by itself.
    """
    return Package(name)


@dataclass(frozen=True)
class Package:
    """What a check may say about a package."""

    name: str

    def expect_built(self, *, executables: Sequence[str] = ()) -> None:
        """It was built by colcon, and `ros2 run` finds these executables in it.

        Raises CheckFailed with what is wrong: a file that is missing, a line of setup.py, a module
        that entry_points name and that is not there.
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
                hint=theirs(shorten(problem, MOST_REASON)) or 'read what colcon prints',
                cause=f'{self.name} is not built as it is',
            )
        listed = told.get('executables')
        there = [each for each in listed if isinstance(each, str)] if type(listed) is list else []
        if missing := [each for each in executables if each not in there]:
            fail(
                expected=f'the executables {", ".join(executables)} in {self.name}',
                seen=theirs(shorten(', '.join(there))) or 'none',
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

        `parameters` become `-p name:=value`, `rules` are remap rules: `{'__ns': '/left'}`. What
        the student had started of the package with `run_executable` is stopped first.
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
    """A value as the parser of parameters reads it. Raises TypeError for what is no parameter."""
    if isinstance(value, bool):
        return 'true' if value else 'false'
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return '"' + value.replace('\\', '\\\\').replace('"', '\\"') + '"'
    if isinstance(value, list | tuple):
        return f'[{", ".join(map(_as_yaml, value))}]'
    raise TypeError(f'a parameter is a bool, a number, a text or a list of these, not {value!r}')
