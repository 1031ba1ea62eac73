"""A worker process that gives a cell half as much time, because many attacks use all of it."""

import sys

from my_robot_basics.validate.kernels import limits

limits.STUDENT_CELL_TIMEOUT_SEC /= 2
limits.REPLY_TIMEOUT_SEC /= 2

from grader.workers.worker import main  # noqa: E402 - what it imports takes over the limits

main(sys.argv[1])
