"""Hints for arguments that publishers and subscriptions lack, depth above all; as error_words."""

from my_robot_basics.feedback.error_words import Case

OF_QUEUES = (
    Case(
        pattern=r"missing \d required positional arguments?: .*'qos_profile'",
        to_do=', so give all arguments: the type, the name, for a subscription the callback, '
        'and the depth of the queue, such as 10, or a QoS profile',
    ),
    Case(
        # as in ROS 1, or before the callback
        pattern="keyword argument 'queue_size'"
        "|Expected QoSProfile or int, but received <class '(?:method|function|str|float)'>",
        to_do=', so give the depth of the queue as a whole number alone, such as 10, after the '
        'other arguments',
    ),
    Case(
        pattern="missing 1 required positional argument: 'callback'",
        to_do=', so give a callback by its name, without parentheses',
    ),
)
