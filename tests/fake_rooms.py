"""Rooms without kernels, in which a test decides the results of checks."""

import asyncio
import time

from doubling_lesson import CANARY
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.verdicts import second_look


class FakeRooms:
    """Rooms without kernels: `checks` has the result of each check, in order."""

    checks: list
    opened = 0

    def __init__(self, **options):
        pass

    async def __aenter__(self):
        type(self).opened += 1
        if self.checks and isinstance(self.checks[0], Exception):
            raise self.checks.pop(0)
        return self

    async def __aexit__(self, *_):
        pass

    student_alive = True
    used_sec = 0.0

    def student_cpu_sec(self):
        return self.used_sec * time.monotonic()

    async def run_student_cell(self, source, *, timeout_sec):
        return CellRun(status='ok')

    async def run_check(self, source):
        if source == second_look.LEAVE_CLOCKS:
            return CellRun(status='ok')
        await asyncio.sleep(0.01)
        return self.checks.pop(0)


def ended(**state):
    error = state.pop('error', None)
    run = CellRun(**{'status': 'error' if error else 'ok'} | state)
    if error:
        run.keep('error', {'ename': error, 'evalue': CANARY, 'traceback': [CANARY, 'assert x']})
    return run


DEAD, LATE = ended(status=None, died=True), ended(timed_out=True)
