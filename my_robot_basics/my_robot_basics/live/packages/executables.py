"""Run executables of a student's package as processes, as `ros2 run` does; report their ends."""

import itertools
import os
import signal
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.exchange.endings import (
    error_in,
    is_clean,
    signal_name,
    was_starting,
    why_code,
    why_crashed,
)
from my_robot_basics.feedback.python_errors import hint_for_exception
from my_robot_basics.live.output import notebook
from my_robot_basics.live.output.panel import Panel, PanelEntry
from my_robot_basics.live.packages.package_build import executables_of, prefix_of
from my_robot_basics.live.packages.processes import Process
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable, tell

_numbers = itertools.count(1)
_started: dict[int, 'Executable'] = {}
MOST_STARTED = 64
"""How many started executables are remembered: the oldest ones that have ended are dropped."""


@dataclass(frozen=True)
class Executable:
    """An executable that was started."""

    package: str
    name: str
    process: Process
    by_check: bool
    panel: 'Panel | None' = None


def start(
    package: str, name: str, arguments: Sequence[str], *, by_check: bool = False
) -> tuple[int, Executable]:
    """Start an executable as `ros2 run` does; return its number, too. Raises NotRunnable.

    Unless a check starts it, its output appears with the cell that runs now.
    """
    classroom.enter()
    path = prefix_of(package) / 'lib' / package / name
    known = executables_of(package)
    if name not in known:
        raise NotRunnable(_why_not_found(package, name, known))
    while len(_started) >= MOST_STARTED and (ended := _oldest_ended()):
        del _started[ended]
    panel = None if by_check else _panel(f'{package} {name}')
    process = Process(
        [str(path), *arguments],
        environment=environment_of(package),
        on_line=panel.line if panel else lambda line: None,
    )
    number = next(_numbers)
    _started[number] = Executable(package, name, process, by_check, panel)
    return number, _started[number]


def find(number: int) -> Executable | None:
    """Return the executable that was started under a number; None if it is unknown."""
    return _started.get(number)


def environment_of(package: str) -> dict[str, str]:
    """Return the variables as sourcing install/setup.bash sets them for a Python package."""
    prefix = prefix_of(package)
    site = prefix / 'lib/python{}.{}/site-packages'.format(*sys.version_info)
    added = {'AMENT_PREFIX_PATH': prefix, 'PYTHONPATH': site, 'PATH': prefix / 'bin'}
    return {name: _prepend_to_variable(name, folder) for name, folder in added.items()}


def stop_started(*, package: str = '', name: str = '', by_notebook_alone: bool = False) -> None:
    """Stop started executables, all or those of a package or name; print how each ended."""
    for number, each in list(_started.items()):
        if package not in ('', each.package) or name not in ('', each.name):
            continue
        if by_notebook_alone and each.by_check:
            continue
        del _started[number]
        if each.process.code is None or each.panel:
            ended = how_it_ended(each, each.process.stop())
            if each.panel:
                each.panel.close(ended)
            if not each.by_check:
                tell(f'{each.name}: {ended}', in_one=False)


def how_it_ended(each: Executable, took: signal.Signals | None) -> str:
    """Return how an executable ended, and what is wrong with that; `took` is from Process.stop."""
    code, last = each.process.code, error_in([*each.process.lines])
    end = _describe_exit(code)
    why = why_crashed(code, at_end=took is not None)
    if took is signal.SIGINT:
        why = why or why_code(code, [*each.process.lines])
    if took is None:
        if code == 0:
            return 'had ended by itself (exit code 0)'
        if last or why:
            last += hint_for_exception(last)
            return f'had ended by itself ({end}): {why or last}'
        return f'had ended by itself ({end})'
    if took is signal.SIGINT and is_clean(code, [*each.process.lines]):
        return 'ended cleanly after SIGINT'  # the exit code may be 1: see RACE in endings.py
    if took is signal.SIGINT and was_starting(code, [*each.process.lines]):
        return (
            'was stopped before it had started: to see how it ends, let it run for a few seconds'
        )
    if took is signal.SIGINT:
        if why:
            return f'ended after SIGINT, but not cleanly ({end}): {why}'
        if last:
            return (
                f'ended after SIGINT, but not cleanly ({end}, with {last}): catch '
                'KeyboardInterrupt and ExternalShutdownException in main'
            )
        return (
            f'ended after SIGINT, but not cleanly ({end}): catch KeyboardInterrupt '
            'and ExternalShutdownException in main'
        )
    return (
        f'did not end after SIGINT: it took {took.name}; a callback or a loop does not return, or '
        'the exception is caught and nothing ends'
    )


def _panel(title: str) -> 'ProcessPanel':
    notebook.open_tap()
    panel = ProcessPanel(title)
    panel.show('running')
    return panel


class ProcessPanel(Panel):
    """A cell's panel with the output of a program."""

    def line(self, text: str) -> None:
        """Add a line that the program has printed."""
        self._add(PanelEntry(text))
        if not notebook.in_kernel():
            print(text, flush=True)


def _why_not_found(package: str, name: str, known: Sequence[str]) -> str:
    if not prefix_of(package).is_dir():
        return (
            f'expected {package} to be built, saw no build: run the cell with '
            f"build_package('{package}') first, and read what it says"
        )
    there = ', '.join(known) or 'none'
    return (
        f'expected an executable {name} in {package}, saw {there}: name it in entry_points of '
        'setup.py, and build again'
    )


def _oldest_ended() -> int | None:
    return next((n for n, each in _started.items() if each.process.code is not None), None)


def _prepend_to_variable(name: str, folder: Path) -> str:
    return os.pathsep.join(filter(None, [str(folder), os.environ.get(name, '')]))


def _describe_exit(exit_code: int | None) -> str:
    if exit_code is not None and exit_code < 0:
        return f'by {signal_name(-exit_code)}'
    return f'exit code {exit_code}'
