"""Whether waiting for the end of a `/move_arm` goal is in vain, according to its feedback."""

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.session.pressure import BUSY_TIMES

FEWEST = 4
"""The least number of feedback messages that show how fast the arm approaches its goal."""


def is_in_vain(sent: SentGoal, *, free_sec: float, since_ns: int = 0) -> bool:
    """Whether a goal cannot end within `free_sec` of free time unless the arm gets faster.

    On a busy machine, this may take BUSY_TIMES as much wall time: the goal cannot end within that,
    either. Only feedback since the wall time `since_ns` counts. False if there is too little of
    it, or if the arm does not approach the goal.
    """
    wanted = list(sent.goal.position)
    told = [
        (sent_ns / 1e9, max(abs(b - a) for a, b in zip(message.position, wanted, strict=True)))
        for sent_ns, message in sent.feedback()
        if sent_ns >= since_ns and len(message.position) == len(wanted) > 0
    ]
    if sent.is_over() or len(told) < FEWEST:
        return False
    later = told[len(told) // 2 - 1 :]  # not the first half: an arm may begin slowly
    passed_sec, gone_rad = later[-1][0] - later[0][0], later[0][1] - later[-1][1]
    return gone_rad > 0.0 and later[-1][1] * passed_sec > BUSY_TIMES * free_sec * gone_rad
