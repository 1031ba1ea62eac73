"""What runs on a worker of a Dask cluster: it takes text and returns text."""

import asyncio
import json
import os
import threading
from functools import cache

from distributed import Worker, get_worker

from grader.common.errors import TaskFailed
from grader.common.versions import software_hash, versions
from grader.kernels.isolation import missing_protection
from grader.sandbox.limits import IN_FLIGHT_EACH
from grader.workers.workers import Workers

_once = threading.Lock()
"""Several threads of a worker may call `_description` at the same time."""


async def describe(dask_worker: Worker) -> str:
    """Return a worker's versions, what its sandbox lacks, and its capacity, as JSON."""
    return await asyncio.to_thread(_description, dask_worker.state.nthreads)


def grade(text: str, wanted: str) -> str:
    """Grade a packed task; return its result as JSON.

    If this worker's `software_hash` is not `wanted`, or it has no sandbox, return why it refuses.
    """
    in_flight = get_worker().state.nthreads
    about = json.loads(_description(in_flight))
    if about['software_hash'] != wanted or about['missing']:
        return json.dumps({'refused': about})
    try:
        return _workers(in_flight).submit_text(text).result()
    except TaskFailed as error:
        return json.dumps({'failed': str(error), 'traceback': error.trace})


@cache
def _workers(in_flight: int) -> Workers:
    """Return this machine's worker processes: they end when this process does, however it ends.

    Dask's threads wait for them; student code never runs in a process of Dask.
    """
    number = min(-(-in_flight // IN_FLIGHT_EACH), len(os.sched_getaffinity(0)))
    return Workers(number, in_flight=in_flight).__enter__()


def _description(in_flight: int) -> str:
    with _once:
        return json.dumps(
            {
                'software_hash': software_hash(),
                'versions': versions(),
                'missing': missing_protection(),
                'capacity': _workers(in_flight).capacity,
            }
        )
