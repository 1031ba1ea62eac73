"""What every test session needs: a ROS domain of its own, and kernels that know of no pytest."""

import os
import shutil
import tempfile

import _pytest.runner
from hypothesis import HealthCheck, settings
from my_robot_basics.live import classroom

# a busy machine fails no test
settings.register_profile('busy', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('busy')


LONG = (
    'same_scores',
    'sample_class',
    'doctor_faults',
    'browser',
    'nbgrader_commands',
    'live_kernel',
)
"""Files that take longest: whoever begins with them does not wait for them at the end."""


def pytest_collection_modifyitems(items: list) -> None:
    items.sort(key=lambda item: item.path.stem.removeprefix('test_') not in LONG)


def pytest_configure() -> None:
    # once in each xdist worker, too: two workers do not hear each other's nodes
    os.environ['MY_ROBOT_BASICS_WORKSPACE'] = tempfile.mkdtemp(prefix='ros ws ')
    classroom.enter()


def pytest_unconfigure() -> None:
    shutil.rmtree(os.environ['MY_ROBOT_BASICS_WORKSPACE'])


# ipykernel leaves the logs of C code alone where it finds PYTEST_CURRENT_TEST, and every kernel
# that a test starts would inherit it: notebooks would behave otherwise than for a student. A hook
# cannot delete it: pytest sets it in the same step that runs the test.
_pytest.runner._update_current_test_var = lambda item, when: None
