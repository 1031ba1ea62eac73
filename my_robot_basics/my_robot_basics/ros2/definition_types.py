"""Types of other languages and of ROS 1, which ROS 2 does not have, and what to write instead."""

OTHER_NAMES = {
    'int': 'int32 or another int with its number of bits',
    **dict.fromkeys(('integer', 'long', 'short', 'unsigned'), 'int32, or uint8 for a small one'),
    'uint': 'uint8 or another uint with its number of bits',
    **dict.fromkeys(('float', 'double', 'real'), 'float64, or float32 for half the digits'),
    **dict.fromkeys(('str', 'String', 'text', 'char*'), 'string'),
    **{f'{kind}{bits}_t': f'{kind}{bits}' for kind in ('int', 'uint') for bits in (8, 16, 32, 64)},
    **dict.fromkeys(('boolean', 'Bool', 'Boolean'), 'bool'),
}
"""Types of other languages, and ROS's types in their place."""
FORMER = {'time': 'Time', 'duration': 'Duration'}
"""Types of ROS 1 that the parser still accepts, but that cannot be built."""
