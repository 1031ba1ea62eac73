"""The feedback on a goal of `/move_arm` whose arm has gone half of its way, from (0, 0)."""

from arm_interfaces.action import MoveArm


def half_way(goal: MoveArm.Goal) -> MoveArm.Feedback:
    """Where the arm is then, and what it has still to go: not yet there, however the goal ends."""
    position = [each / 2.0 for each in goal.position]
    return MoveArm.Feedback(position=position, remaining=max(map(abs, position), default=0.0))
