"""nbgrader's own Validator, run on many notebooks as JupyterLab's button would, for tests."""

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
"""Prefixes of variables of a test session, which a student's JupyterLab does not have."""


@contextmanager
def validators(at_a_time: int = 4) -> Iterator[Callable[[Iterable[Path]], dict[str, dict]]]:
    """Yield a function that puts notebooks through nbgrader's stock Validator, several at a time.

    It returns, by the file's stem, the Validator's own answer ('failed', 'changed' and
    'type_changed' are lists of cells, with their source), or {'broken': why} if it raised.
    """
    context = multiprocessing.get_context('forkserver')  # imports nbgrader, which is slow, once
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

    # kernels of other tests may take the TCP ports that were chosen for this kernel
    with TemporaryDirectory(prefix='validate-') as sockets:
        config = Config(KernelManager={'transport': 'ipc', 'ip': f'{sockets}/zmq'})
        # a workspace for each student: it can't have two packages of the same name
        os.environ['MY_ROBOT_BASICS_WORKSPACE'] = f'{sockets}/ros_ws'
        try:
            return Validator(config=config).validate(str(path))
        except Exception as error:
            return {'broken': f'{type(error).__name__}: {error}'}
