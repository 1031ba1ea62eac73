"""What every test session needs: a ROS domain of its own, and kernels that know of no pytest."""

import _pytest.runner
from my_robot_basics.live import classroom


def pytest_configure() -> None:
    # once in each xdist worker, too: two workers do not hear each other's nodes
    classroom.enter()


# ipykernel leaves the logs of C code alone when it finds PYTEST_CURRENT_TEST, which every kernel
# started by a test would inherit: a notebook would then behave otherwise than for a student. A hook
# cannot delete it: pytest sets it in the same step that runs the test.
_pytest.runner._update_current_test_var = lambda item, when: None
