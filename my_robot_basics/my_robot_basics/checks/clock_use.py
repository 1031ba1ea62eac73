"""Whether checks drive the robot's clock at all in this process."""

LEFT_ALONE = "the nodes' clocks are left alone"

_are_left_alone = False


def leave_alone() -> None:
    """Drive no clock from now on: a node may take a change of its clock amiss."""
    global _are_left_alone
    _are_left_alone = True


def are_left_alone() -> bool:
    """Whether no clock is driven."""
    return _are_left_alone
