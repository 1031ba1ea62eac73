"""A `dask worker --preload` module: the worker grades without rooms, as toy_worker.py does.

It takes its versions and missing protection from the environment: TOY_NUMPY, TOY_MISSING.
"""

import os
import sys
from importlib.metadata import version
from pathlib import Path

from grader.workers import dask_worker, workers

workers.COMMAND = (sys.executable, str(Path(__file__).with_name('toy_worker.py')))
dask_worker.versions = lambda: {'numpy': os.environ.get('TOY_NUMPY', version('numpy'))}
dask_worker.software_hash = lambda: f'toy, numpy {dask_worker.versions()["numpy"]}'
dask_worker.missing_protection = lambda: os.environ.get('TOY_MISSING', '')
