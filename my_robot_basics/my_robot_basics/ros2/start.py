"""Run a tool of the installed package: `start.py MODULE ARGUMENT...` runs that module's main.

In a terminal in which a workspace was sourced, PYTHONPATH lists the student's copy of the package
first: `ros2 run` starts the nodes of that copy, but the tools have to come from the installed one.
"""

import sys
from importlib import import_module
from pathlib import Path


def main() -> int | str | None:
    """Run the tool, and return what `sys.exit` takes."""
    installed = str(Path(__file__).resolve().parents[2])
    module = sys.argv.pop(1)
    sys.path.insert(0, installed)
    run = import_module(f'my_robot_basics.{module}').main
    sys.path.remove(installed)
    return run()


if __name__ == '__main__':
    sys.exit(main())
