"""The joints of a JointState by name, and what to say where they are not as asked for."""

from sensor_msgs.msg import JointState

EXACT_RAD = 2e-4
CLOSE_RAD = 0.02
"""Who rounds to two decimals is no further off."""


def pose(message: JointState) -> dict[str, float]:
    """Return each joint's position, to four decimals; nothing where names and positions differ."""
    if len(message.name) != len(message.position):
        return {}
    pairs = zip(message.name, message.position, strict=True)
    return {name: round(position, 4) for name, position in pairs}


def agree(seen: dict[str, float], right: dict[str, float], within_rad: float = EXACT_RAD) -> bool:
    """Whether each joint of `right` is there, and where it should be."""
    return all(
        joint in seen and abs(seen[joint] - position) < within_rad
        for joint, position in right.items()
    )


def shown(message: JointState) -> dict[str, float] | str:
    """What the feedback shows of a message."""
    names, positions = len(message.name), len(message.position)
    return pose(message) or f'{positions} positions with {names} names'


def what_to_try(seen: dict[str, float], right: dict[str, float]) -> str:
    """Advice for a pose that is not the right one, both as `pose` returns them."""
    if seen.keys() != right.keys():
        return f'give each message two positions, and the names {" and ".join(right)}'
    if agree(seen, right, CLOSE_RAD):
        return 'close: take math.radians() itself, and do not round'
    if {*seen.values()} == {*right.values()}:
        return 'put x beside the name joint1, and y beside joint2'
    return 'convert both with math.radians(…), x for the name joint1 and y for joint2'
