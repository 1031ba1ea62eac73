"""Feedback on a goal of `/move_arm` when the arm is half way from (0, 0) to the goal."""

from arm_interfaces.action import MoveArm


def half_way(goal: MoveArm.Goal) -> MoveArm.Feedback:
    """Return the feedback half way: the arm is not at the goal yet, however the goal ends."""
    position = [each / 2.0 for each in goal.position]
    return MoveArm.Feedback(position=position, remaining=max(map(abs, position), default=0.0))
