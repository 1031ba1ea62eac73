"""What in a package's own code keeps a program from ending with Ctrl-C, as far as it shows."""

import re
from pathlib import Path

from my_robot_basics.session import package_files

_OWN = re.compile(
    r'\bsignal\(\s*(?:\w+\.)*SIGINT\b'
    r'|\bSignalHandlerOptions\.(?:NO|SIGTERM)\b'
    r'|\buninstall_signal_handlers\('
)

_CALL = re.compile(r'\.call\(')


def handles_ctrl_c(folder: Path) -> bool:
    """Whether Python code in a package's folder takes SIGINT from rclpy."""
    return _is_in_code(folder, _OWN)


def waits_in_call(folder: Path) -> bool:
    """Whether it calls a method `call`, which waits for a response even after Ctrl-C."""
    return _is_in_code(folder, _CALL)


def _is_in_code(folder: Path, pattern: re.Pattern[str]) -> bool:
    try:
        taken = package_files.read(folder).taken
        texts = (package_files.read_plain_file(taken[n]) for n in taken if n.endswith('.py'))
        return any(pattern.search(text.decode(errors='replace')) for text in texts)
    except OSError:  # the folder, or a file of it, has gone
        return False
