"""The grade cells' checks of a server of /move_arm."""

from my_robot_basics.checks import CheckFailed, action, moves

from arm_interfaces.action import MoveArm


def reaches(move_arm):
    moves.expect_reaches(move_arm, (1.2, -0.6), speed=0.1)
    moves.expect_reaches(move_arm, (-0.9, 0.4), speed=0.2, start=(0.8, -0.3))


def feedback(move_arm):
    moves.expect_feedback(move_arm, (1.2, -0.6), speed=0.2)


def cancels(move_arm):
    moves.expect_cancels(move_arm, (1.2, -0.6), speed=0.15)
    moves.expect_late_cancel(move_arm, (0.9, 0.3))


def rejects(move_arm):
    moves.expect_rejects(
        move_arm,
        moves.goal((0.5, 0.5), speed=0.0),
        moves.goal((0.5,)),
        moves.goal((float('nan'), 0.5)),
        moves.goal((1.7, 0.0)),
    )
    moves.expect_one_at_a_time(move_arm, (0.9, 0.3), (-0.5, 1.0))


CHECKS = [reaches, feedback, cancels, rejects]
"""The checks, in the order of the grade cells."""


def failures():
    """Run all checks; return the messages of those that fail, by name."""
    move_arm, found = action('/move_arm', MoveArm), {}
    for check in CHECKS:
        try:
            check(move_arm)
        except CheckFailed as failure:
            found[check.__name__] = str(failure)
    return found
