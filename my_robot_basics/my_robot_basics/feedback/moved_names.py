"""Hints for names that are in another package, or that an older ROS 2 had; as in error_words."""

from my_robot_basics.feedback.error_words import Case

MOVED = (
    Case(
        pattern=r"cannot import name '\w+' from '\w+\.(?:msg|srv|action)'",
        to_do=', so import it from the package that has it, such as sensor_msgs.msg for '
        'JointState',
    ),
    Case(
        pattern="object has no attribute 'set_parameters_callback'",
        to_do=', so write add_on_set_parameters_callback, its name since ROS 2 Galactic',
    ),
)
