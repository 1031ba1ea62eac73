"""nbgrader's own Validate, as JupyterLab's button runs it, on many notebooks for test modules."""

import logging
import multiprocessing
import os
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from traitlets.config import Config

OURS = ('MY_ROBOT_BASICS_', 'ROS_', 'RCUTILS_', 'FASTRTPS_', 'PYTEST_', 'JPY_')
"""What a test session has in its environment and a student's JupyterLab has not."""


def validate_all(paths: Iterable[Path], *, at_a_time: int = 6) -> dict[str, dict]:
    """Put notebooks through nbgrader's stock Validator; return what it found, by the file's stem.

    That is the Validator's own answer ('failed', 'changed' and 'type_changed' are lists of cells,
    by their source), or {'broken': why} where it came to none.
    """
    spawn = multiprocessing.get_context('spawn')
    with ProcessPoolExecutor(at_a_time, mp_context=spawn, initializer=_leave_the_tests) as pool:
        paths = list(paths)
        return dict(zip([path.stem for path in paths], pool.map(_validate, paths), strict=True))


def _leave_the_tests() -> None:
    for name in [name for name in os.environ if name.startswith(OURS)]:
        del os.environ[name]
    logging.disable()


def _validate(path: Path) -> dict:
    from nbgrader.validator import Validator

    # kernels of other tests may take the TCP ports that were chosen for this one
    with TemporaryDirectory(prefix='validate-') as sockets:
        config = Config(KernelManager={'transport': 'ipc', 'ip': f'{sockets}/zmq'})
        try:
            return Validator(config=config).validate(str(path))
        except Exception as error:
            return {'broken': f'{type(error).__name__}: {error}'}
