"""The main program of a worker: fork servers start before the slow imports, and import meanwhile.

`python -m grader.workers.begin_worker HANDLE` is started by grader.workers; it has no other use.
"""

import gc
import sys

from grader.common.lean_imports import leave_out_formats, pause_garbage_collection
from grader.kernels.fork_servers import start_servers


def main(handle: str) -> None:
    """Serve the socket with that file descriptor."""
    start_servers()
    with pause_garbage_collection():
        leave_out_formats()
        from grader.workers import worker

        worker.prepare()
    worker.main(handle)
    gc.freeze()  # or Python searches all objects for garbage before it exits


if __name__ == '__main__':
    main(sys.argv[1])
