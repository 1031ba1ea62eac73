"""Schedulers and workers of Dask in separate processes, for tests."""

import os
import subprocess
import sys
import time
from pathlib import Path

DASK = Path(sys.executable).with_name('dask')
TESTS = Path(__file__).parent


def starter(folder):
    """Yield a function that starts a scheduler or a worker, as a fixture does; end them all."""
    started = []

    def start(*arguments, on=(), **environment):
        log = folder / f'dask {len(started)}.log'
        with log.open('w') as file:
            process = subprocess.Popen(
                [*on, DASK, *arguments, '--no-dashboard'],
                env=os.environ | {'PYTHONPATH': str(TESTS)} | environment,
                stdout=file,
                stderr=file,
            )
        process.log = log
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.wait()


def start_scheduler(start, port=0, options=()):
    process = start('scheduler', '--host', '127.0.0.1', '--port', str(port), *options)
    mark = 'Scheduler at:'
    wait_for(lambda: mark in process.log.read_text(), process)
    process.address = process.log.read_text().partition(mark)[2].split()[0]
    return process


def wait_for(happened, process=None):
    deadline = time.monotonic() + 120
    while not happened():
        assert process is None or process.poll() is None, process.log.read_text()
        assert time.monotonic() < deadline
        time.sleep(0.05)
