"""Random inputs that a student cannot guess, and that a second grading repeats."""

import os
import random

from my_robot_basics.feedback import hidden


def inputs(label: str) -> random.Random:
    """A random generator for the check of that label: `inputs('reach').uniform(0.2, 1.8)`.

    Its numbers depend only on the label and on MY_ROBOT_BASICS_SEED, which the grader sets for
    each student. Without a seed, as in a student's own kernel, they differ each time.
    """
    hidden.note_inputs()
    seed = os.environ.get('MY_ROBOT_BASICS_SEED')
    return random.Random(f'{seed}:{label}') if seed else random.Random()
