"""Hints for names of ROS 1, of an older ROS 2, or of another package or place; as error_words."""

from my_robot_basics.feedback.error_words import Case

MOVED = (
    Case(
        pattern=r"No module named '\w+_(?:msgs|srvs|interfaces)\.(?:msg|srv|action)'"
        r"|cannot import name '(?:SolveIK|MoveArm)' from 'arm_interfaces\b",
        to_do=', so import a message from .msg, a service such as SolveIK from .srv, and an '
        'action such as MoveArm from .action',
    ),
    Case(
        pattern=r"cannot import name '\w+' from '\w+(?:\.(?:msg|srv|action)|_msgs|_interfaces)'",
        to_do=', so import it from the package that has it, such as sensor_msgs.msg for '
        'JointState',
    ),
    Case(
        pattern="object has no attribute 'set_parameters_callback'",
        to_do=', so write add_on_set_parameters_callback, its name since ROS 2 Galactic',
    ),
    Case(
        pattern="name 'rospy' is not defined|No module named 'rospy'",
        to_do=', so write what the lesson shows: rospy belongs to ROS 1, and ROS 2 has rclpy '
        'instead',
    ),
    Case(
        # copied from a method
        pattern="name 'self' is not defined",
        to_do=', so use self in the methods of a class alone, and make it the first parameter of '
        'each: a function outside of a class has none',
    ),
    Case(
        pattern="type object 'Time' has no attribute 'now'",
        to_do=', so ask a clock for the time: in a node, self.get_clock().now()',
    ),
    Case(
        # builtin_interfaces.msg.Time; that of rclpy has this method
        pattern="'Time' object has no attribute 'to_msg'",
        to_do=', so leave out .to_msg(): this time is a message already',
    ),
    Case(
        pattern=r"No module named '[\w.]+'",
        to_do=', so check its spelling, and use only modules that the course installs; one that '
        'lies beside your own is imported from its package: from my_package.ends import ENDS',
    ),
)
