"""What `dask worker --preload` makes of a worker: it grades without rooms, as toy_worker.py does.

What it says of itself is in the environment: TOY_NUMPY, TOY_MISSING.
"""

import os
import sys
from importlib.metadata import version
from pathlib import Path

from grader import remote, workers

workers.COMMAND = (sys.executable, str(Path(__file__).with_name('toy_worker.py')))
remote.versions = lambda: {'numpy': os.environ.get('TOY_NUMPY', version('numpy'))}
remote.machinery = lambda: f'toy, numpy {remote.versions()["numpy"]}'
remote.missing = lambda: os.environ.get('TOY_MISSING', '')
