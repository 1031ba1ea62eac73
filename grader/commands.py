# PYTHON_ARGCOMPLETE_OK
"""The console scripts `ros2` and `topic_doctor`: those of the installed my_robot_basics, always.

In a terminal in which a workspace was sourced, PYTHONPATH names the student's copy of the package
first: the nodes of that copy are what `ros2 run` starts, but the tools are not to be sought there.
"""

import sys
from importlib import import_module
from pathlib import Path

INSTALLED = Path(__file__).parents[1] / 'my_robot_basics'


def ros2() -> int | str | None:
    """Run `ros2`."""
    return _run('my_robot_basics.ros2.main')


def topic_doctor() -> int | str | None:
    """Run `topic_doctor`."""
    return _run('my_robot_basics.doctor.main')


def _run(module: str) -> int | str | None:
    sys.path.insert(0, str(INSTALLED))
    main = import_module(module).main
    sys.path.remove(str(INSTALLED))
    return main()
