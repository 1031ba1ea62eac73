"""Run command lines of a notebook as processes, as `ros2 run` does, without a shell."""

import sys
import threading
import time
from pathlib import Path

from my_robot_basics.live.packages.processes import Process
from my_robot_basics.ros2 import command_line, packages
from my_robot_basics.session import classroom
from my_robot_basics.session.errors import NotRunnable, tell

STARTED_SEC = 6.0
"""How long a cell waits for the first log line of its commands, or their end."""
MOST_OF_A_WORD = 60
"""How many characters of a wrong word are quoted."""
_PACKAGE = 'my_robot_basics'
_OWN_WORDS = 4
"""How many words of `ros2 run PACKAGE EXECUTABLE` come before the program's arguments."""
_running: list['_Command'] = []


class _Command(Process):
    """One process, and the last line that it has printed."""

    def __init__(self, executable: Path, words: tuple[str, ...]) -> None:
        self.last_line = ''
        self.has_spoken = threading.Event()
        super().__init__(
            [str(executable), *words],
            on_line=self._receive,
            on_end=lambda code: self.has_spoken.set(),
        )

    def _receive(self, line: str) -> None:
        self.last_line = line.strip()
        if line.startswith('[INFO]'):  # a log line: the node has started
            self.has_spoken.set()


def run_commands(*names: str, executable: str = 'kinematics_publisher') -> None:
    """Start the command lines that these variables of the notebook contain, each as a process.

    Each has to be `ros2 run my_robot_basics EXECUTABLE --ros-args …`; no shell reads it. Former
    commands are stopped first; `stop()` and `reset()` stop them, too, and they end with the
    kernel. If one ends by itself, its last line is printed. Raises NotRunnable for any other
    command line.
    """
    stop_commands()
    classroom.enter()
    lines = {name: _read(name, executable) for name in names}
    path = _executable(executable)
    for line in lines.values():
        _running.append(_Command(path, line.words[_OWN_WORDS:]))
    deadline = time.monotonic() + STARTED_SEC
    for name, command in zip(lines, _running, strict=True):
        command.has_spoken.wait(max(0.0, deadline - time.monotonic()))
        if command.process.poll() is None:
            tell(f'{name}: started')
        else:
            why = _why_refused(lines[name]) or command.last_line
            tell(f'{name}: ended by itself: {why}', in_one=False)


def _why_refused(line: command_line.CommandLine) -> str:
    """Say which word of the command line rcl refuses, for which it has no plain words; or ''."""
    if unfit := line.without_sign(*command_line.OPTIONS_OF_PARAMETERS):
        return f'a parameter is written name:=value, so put := into {unfit[:MOST_OF_A_WORD]!r}'
    if unfit := line.without_sign(*command_line.OPTIONS_OF_RULES):
        return f'a rule is written name:=new_name, so put := into {unfit[:MOST_OF_A_WORD]!r}'
    return ''


def pids() -> set[int]:
    """Return the process IDs of the commands that `run_commands` has started last."""
    return {command.process.pid for command in _running}


def stop_commands() -> None:
    """Stop all processes that `run_commands` has started."""
    while _running:
        _running.pop().stop()


def _executable(name: str) -> Path:
    """Return the program to start directly: `ros2 run` would take as long again as the node."""
    return next(path for path in packages.executables(_PACKAGE) if path.name == name)


def _read(name: str, executable: str) -> command_line.CommandLine:
    text = vars(sys.modules['__main__']).get(name)
    if text is None:
        raise NotRunnable(
            f'expected a command line {name}, saw nothing of that name: write it in the answer '
            'cell, and run the cell'
        )
    if type(text) is not str:
        raise NotRunnable(
            f'expected {name} to be a text, saw {type(text).__name__}: put it in quotes, and no '
            'comma behind them'
        )
    try:
        return command_line.parse(text, package=_PACKAGE, executable=executable)
    except command_line.BadCommandLine as error:
        raise NotRunnable(f'{name}: expected one command line, saw {error}') from None
