"""What the executable `arm_player` must do with its targets; in metres, in `base_link`.

The check serves `/solve_ik` and `/move_arm` itself and decides how each target ends. Its arm has
other link lengths than the course's, so only a client that calls `/solve_ik` knows the angles.
"""

import math
import random

from my_robot_basics.checks.actions.action_ends import TERMINAL
from my_robot_basics.checks.packages.drawing import QUIET_SEC, Drawing
from my_robot_basics.checks.packages.player_servers import WORDS, Target
from my_robot_basics.graph.watcher import Watcher

NEAREST_M, FARTHEST_M = 0.6, 1.7
"""`choose` takes targets at these distances from the origin: between the two circles."""
APART_M = 0.1
"""Two different targets of `choose` are at least this far apart."""


def expect_plays(
    *targets: Target,
    first_goal_sec: float = QUIET_SEC,
    arm_first: bool = False,
    stays_sec: float = 0.0,
) -> None:
    """`arm_player` visits the targets in order, one at a time, and reports how each one ended.

    A target is a word and a point, `('succeeded', 1.2, 0.8)`. The word is 'succeeded', 'canceled'
    or 'aborted', which is how its goal ends; 'rejected', which its goal is; or 'unreachable',
    which `/solve_ik` answers. The first accepted goal takes `first_goal_sec`, the others
    QUIET_SEC: an arm is slow, and a right node waits for it. `arm_first`: `/move_arm` appears
    before `/solve_ik`, otherwise after it. `stays_sec` of free time after its report the node
    still runs. Raises CheckFailed.
    """
    for word, _, _ in targets:
        if word not in WORDS:
            raise ValueError(f'a target ends as one of {", ".join(WORDS)}, not {word}')
    with Watcher() as watcher, Drawing.opened(watcher, targets) as drawing:
        drawing.expect_waits_for_both(arm_first=arm_first)
        moves = [number for number, (word, _, _) in enumerate(targets) if word in TERMINAL]
        for number in range(len(targets)):
            is_first = number in moves[:1]
            drawing.expect_visit(number, goal_sec=first_goal_sec if is_first else QUIET_SEC)
        drawing.expect_end(stays_sec=stays_sec)


def expect_asks_and_ends(x: float, y: float) -> None:
    """`arm_player` calls `/solve_ik` for its first target, and ends cleanly while it waits.

    Raises CheckFailed.
    """
    with Watcher() as watcher, Drawing.opened(watcher, [('succeeded', x, y)]) as drawing:
        drawing.expect_clean_end()


def expect_ends_after_report(x: float, y: float) -> None:
    """`arm_player` ends cleanly once it has reported that its only target is unreachable.

    Raises CheckFailed. Whether it reports at all is checked by `expect_plays`.
    """
    with Watcher() as watcher, Drawing.opened(watcher, [('unreachable', x, y)]) as drawing:
        drawing.expect_clean_end(after_report=True)


def choose(numbers: random.Random) -> list[Target]:
    """One target for each word in random order, another one that succeeds, and one repetition.

    The repetition is that of a target that succeeds.
    """
    words = [*WORDS]
    numbers.shuffle(words)
    targets: list[Target] = []
    for word in (*words, 'succeeded'):
        point = _point(numbers)
        while any(math.dist(point, other[1:]) < APART_M for other in targets):
            point = _point(numbers)
        targets.append((word, *point))
    again = next(each for each in targets if each[0] == 'succeeded')
    return [*targets, again]


def _point(numbers: random.Random) -> tuple[float, float]:
    distance = numbers.uniform(NEAREST_M, FARTHEST_M)
    angle = numbers.uniform(-math.pi, math.pi)
    return round(distance * math.cos(angle), 3), round(distance * math.sin(angle), 3)
