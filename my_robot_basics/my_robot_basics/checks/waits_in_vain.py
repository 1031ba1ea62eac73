"""Whether the end of a move of `/move_arm` is waited for in vain, as its feedback tells."""

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.session.pressure import BUSY_TIMES

FEWEST = 4
"""So much feedback tells how fast the arm comes nearer."""


def is_in_vain(sent: SentGoal, *, free_sec: float, since_ns: int = 0) -> bool:
    """Whether a goal does not end within that time, unless the arm gets faster.

    Nor does it if the machine is so busy that this takes as long as it may. Feedback counts since
    a wall time; False where there is too little, or it tells of no arm that comes nearer.
    """
    wanted = list(sent.goal.position)
    told = [
        (sent_ns / 1e9, max(abs(b - a) for a, b in zip(message.position, wanted, strict=True)))
        for sent_ns, message in sent.feedback()
        if sent_ns >= since_ns and len(message.position) == len(wanted) > 0
    ]
    if sent.is_over() or len(told) < FEWEST:
        return False
    later = told[len(told) // 2 - 1 :]  # an arm may begin slowly
    passed_sec, gone_rad = later[-1][0] - later[0][0], later[0][1] - later[-1][1]
    return gone_rad > 0.0 and later[-1][1] * passed_sec > BUSY_TIMES * free_sec * gone_rad
