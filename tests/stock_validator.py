"""nbgrader's own Validate, as JupyterLab's button runs it, on many notebooks for test modules."""

import logging
import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from traitlets.config import Config

OURS = ('MY_ROBOT_BASICS_', 'ROS_', 'RCUTILS_', 'FASTRTPS_', 'PYTEST_', 'JPY_')
"""What a test session has in its environment and a student's JupyterLab has not."""


@contextmanager
def validators(at_a_time: int = 4) -> Iterator[Callable[[Iterable[Path]], dict[str, dict]]]:
    """Yield a function that puts notebooks through nbgrader's stock Validator, several at a time.

    What it returns, by the file's stem, is the Validator's own answer ('failed', 'changed' and
    'type_changed' are lists of cells, by their source), or {'broken': why} where it came to none.
    """
    context = multiprocessing.get_context('forkserver')  # each importing nbgrader takes long
    context.set_forkserver_preload(['nbgrader.validator', __name__])
    with ProcessPoolExecutor(at_a_time, mp_context=context, initializer=_leave_the_tests) as pool:

        def validate_all(paths: Iterable[Path]) -> dict[str, dict]:
            paths = list(paths)
            found = pool.map(_validate, paths)
            return dict(zip([path.stem for path in paths], found, strict=True))

        yield validate_all


def _leave_the_tests() -> None:
    for name in [name for name in os.environ if name.startswith(OURS)]:
        del os.environ[name]
    logging.disable()


def _validate(path: Path) -> dict:
    from nbgrader.validator import Validator

    # kernels of other tests may take the TCP ports that were chosen for this one
    with TemporaryDirectory(prefix='validate-') as sockets:
        config = Config(KernelManager={'transport': 'ipc', 'ip': f'{sockets}/zmq'})
        # each student has a workspace of their own: of two packages of one name, one would stay
        os.environ['MY_ROBOT_BASICS_WORKSPACE'] = f'{sockets}/ros_ws'
        try:
            return Validator(config=config).validate(str(path))
        except Exception as error:
            return {'broken': f'{type(error).__name__}: {error}'}
