"""The process of a worker, before what takes long to import: its servers import meanwhile.

`python -m grader.workers.begin_worker HANDLE` is started by grader.workers, and is of no use
otherwise.
"""

import gc
import sys

from grader.common.lean_imports import leave_out_formats, uncollected
from grader.kernels.fork_servers import start_servers


def main(handle: str) -> None:
    """Serve the socket of that number."""
    start_servers()
    with uncollected():
        leave_out_formats()
        from grader.workers import worker

        worker.prepare()
    worker.main(handle)
    gc.freeze()  # or Python looks through all of it for garbage before it ends


if __name__ == '__main__':
    main(sys.argv[1])
