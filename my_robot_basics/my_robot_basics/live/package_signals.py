"""Whether a package's own code handles Ctrl-C in place of rclpy."""

import re
from pathlib import Path

from my_robot_basics.session import package_files

_OWN = re.compile(
    r'\bsignal\(\s*(?:\w+\.)*SIGINT\b'
    r'|\bSignalHandlerOptions\.(?:NO|SIGTERM)\b'
    r'|\buninstall_signal_handlers\('
)


def handles_ctrl_c(folder: Path) -> bool:
    """Whether Python code in a package's folder takes SIGINT from rclpy, as far as it shows."""
    try:
        taken = package_files.read(folder).taken
        texts = (package_files.read_plain_file(taken[n]) for n in taken if n.endswith('.py'))
        return any(_OWN.search(text.decode(errors='replace')) for text in texts)
    except OSError:  # the folder, or a file of it, has gone
        return False
