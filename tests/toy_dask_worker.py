"""What `dask worker --preload` makes of a worker: it grades without rooms, as toy_worker.py does.

What it says of itself is in the environment: TOY_NUMPY, TOY_MISSING.
"""

import os
import sys
from importlib.metadata import version
from pathlib import Path

from grader.workers import dask_worker, workers

workers.COMMAND = (sys.executable, str(Path(__file__).with_name('toy_worker.py')))
dask_worker.versions = lambda: {'numpy': os.environ.get('TOY_NUMPY', version('numpy'))}
dask_worker.machinery = lambda: f'toy, numpy {dask_worker.versions()["numpy"]}'
dask_worker.missing = lambda: os.environ.get('TOY_MISSING', '')
