"""Hints for calls that ROS 1 expects, and that raise in ROS 2; as in error_words."""

from my_robot_basics.feedback.error_words import Case

OF_ROS1 = (
    Case(
        pattern="'Client' object is not callable",
        to_do=', so send the request with the method call_async of the client',
    ),
    Case(
        pattern="'Publisher' object is not callable",
        to_do=', so send the message with the method publish of the publisher',
    ),
    Case(
        pattern="a real number, not 'Duration'",
        to_do=', so give the number of seconds itself, such as 0.2, and no Duration',
    ),
)
