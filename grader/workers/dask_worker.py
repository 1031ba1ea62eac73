"""What runs on a worker of a Dask cluster: text goes in, text comes out."""

import asyncio
import json
import os
import threading
from functools import cache

from distributed import Worker, get_worker

from grader.common.errors import TaskFailed
from grader.common.versions import machinery, versions
from grader.kernels.isolation import missing
from grader.sandbox.limits import IN_FLIGHT_EACH
from grader.workers.workers import Workers

_once = threading.Lock()
"""Several threads of a worker ask at the same time."""


async def describe(dask_worker: Worker) -> str:
    """Return as JSON what a worker grades with, what its sandbox lacks, and its room."""
    return await asyncio.to_thread(_described, dask_worker.state.nthreads)


def grade(text: str, wanted: str) -> str:
    """Grade a packed task; return what came of it as JSON.

    Or why this worker refuses to: it is not the `wanted` machinery, or has no sandbox.
    """
    in_flight = get_worker().state.nthreads
    about = json.loads(_described(in_flight))
    if about['machinery'] != wanted or about['missing']:
        return json.dumps({'refused': about})
    try:
        return _workers(in_flight).submit_text(text).result()
    except TaskFailed as error:
        return json.dumps({'failed': str(error), 'traceback': error.trace})


@cache
def _workers(in_flight: int) -> Workers:
    """Return this machine's worker processes: they end when this process does, however it ends.

    Threads of Dask's wait for them; student code is run by none of Dask's processes.
    """
    number = min(-(-in_flight // IN_FLIGHT_EACH), len(os.sched_getaffinity(0)))
    return Workers(number, in_flight=in_flight).__enter__()


def _described(in_flight: int) -> str:
    with _once:
        return json.dumps(
            {
                'machinery': machinery(),
                'versions': versions(),
                'missing': missing(),
                'capacity': _workers(in_flight).capacity,
            }
        )
