"""Grade on many machines: a Dask cluster does what worker processes do on this machine."""

import json
import sys
import threading
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, Self

from grader.common.errors import ClusterError, TaskFailed
from grader.common.versions import software_hash, versions
from grader.judging.task import GradingTask, Result, pack, unpack
from grader.workers.dask_client import CONNECT_TIMEOUT_SEC, Certificates, check_address, connect

_START = 'Start workers from the same checkout, set up by ./course: .venv/bin/dask worker ADDRESS'
LOOK_SEC = 5.0
"""Interval at which we check whether the scheduler is still there."""


class Cluster:
    """Grades tasks on a Dask scheduler's workers; at the end of `with`, the rest is cancelled."""

    def __init__(self, address: str, certificates: Certificates | None = None) -> None:
        """Raises ClusterError if the address is invalid or not safe to use."""
        check_address(address)
        self._address = address
        self._certificates = certificates or Certificates()
        self._asked: dict[Any, Future[Result]] = {}
        self._left = threading.Event()
        self.capacity = 0

    def __enter__(self) -> Self:
        """Connect, and check each worker: raises ClusterError if one would not grade as we do."""
        self._client = connect(self._address, self._certificates)
        try:
            self.capacity = self._check_workers()
        except BaseException:
            self._client.close()
            raise
        watch = self._warn_without_workers
        self._watch = threading.Thread(target=watch, name='cluster', daemon=True)
        self._watch.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Cancel unfinished tasks; results of those that a worker is grading are discarded."""
        self._left.set()
        self._watch.join()
        if self._client.status == 'running':
            self._client.cancel(list(self._asked))
        self._client.close()

    def begin(self) -> None:
        """Do nothing: a cluster's workers are running already."""

    def require_isolation(self, *, trust_students: bool = False) -> bool:
        """Return True: a worker without a sandbox grades nothing."""
        return True

    def submit(self, task: GradingTask) -> 'Future[Result]':
        """Have a task graded.

        The future raises TaskFailed if there is no result, and ClusterError if the connection is
        lost.
        """
        from grader.workers import dask_worker  # imports Dask, which is not needed on one machine

        work: Future[Result] = Future()
        asked = self._client.submit(dask_worker.grade, pack(task), software_hash(), pure=False)
        self._asked[asked] = work
        asked.add_done_callback(lambda done: self._set_result(done, task))
        return work

    def _set_result(self, asked: Any, task: GradingTask) -> None:
        """Set the result of a task; Dask calls this in a thread of its own."""
        work = self._asked.pop(asked)
        try:
            if asked.status == 'cancelled':
                raise ClusterError(
                    f'the connection to {self._address} is lost. What was stored before is kept: '
                    'once the scheduler runs again, run the same command again, and it goes on.'
                )
            answer = asked.result()
            if refused := _refusal_in(answer):
                raise ClusterError(f'a worker of {self._address} {_difference(refused)}')
            work.set_result(unpack(answer, task))
        except ClusterError as error:
            work.set_exception(error)
        except Exception as error:  # for example because several workers died of it
            work.set_exception(
                error
                if isinstance(error, TaskFailed)
                else TaskFailed(f'{type(error).__name__}: {error}')
            )

    def _check_workers(self) -> int:
        """Return how many submissions all workers take. Raises ClusterError for a bad worker."""
        from grader.workers import dask_worker

        with suppress(TimeoutError):
            self._client.wait_for_workers(1, timeout=CONNECT_TIMEOUT_SEC)
        capacity = 0
        for address, said in self._client.run(dask_worker.describe, on_error='return').items():
            check_address(address)
            if isinstance(said, OSError):
                continue  # this worker is gone
            if isinstance(said, BaseException):
                raise ClusterError(
                    f"the worker {address} can't grade: {type(said).__name__}: {said}. {_START}"
                )
            about = json.loads(said)
            if about['missing'] or about['software_hash'] != software_hash():
                raise ClusterError(f'the worker {address} {_difference(about)}')
            capacity += about['capacity']
        if not capacity:
            raise ClusterError(f'{self._address} has no workers. {_START}')
        return capacity

    def _warn_without_workers(self) -> None:
        """Warn if there is no worker; tasks then wait for one."""
        warned = False
        while not self._left.wait(LOOK_SEC):
            try:
                workers = self._client.scheduler_info()['workers']
            except (OSError, ValueError, KeyError):  # the scheduler is gone; the futures report it
                return
            if not workers and not warned:
                print(f'waiting: {self._address} has lost all workers', file=sys.stderr)
            warned = not workers


def _refusal_in(answer: str) -> dict | None:
    try:
        found = json.loads(answer)
    except ValueError:
        return None
    return found.get('refused') if isinstance(found, dict) else None


def _difference(about: dict) -> str:
    """Return in a sentence why a worker is not accepted."""
    if about['missing']:
        return f'refuses: {about["missing"]}'
    ours = versions()
    others = [
        f'{name} {its}, and {ours[name]} here'
        for name, its in about['versions'].items()
        if name != 'system' and its != ours.get(name)
    ]
    listed = '; '.join(others) or 'other packages are installed there'
    return f'would not grade as this machine does: {listed}. {_START}'
