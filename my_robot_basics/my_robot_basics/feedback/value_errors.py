"""Hints for values of a wrong type, in messages' arrays and in parameters; as error_words."""

from my_robot_basics.feedback.error_words import Case

OF_VALUES = (
    Case(
        # message.position is an array.array, and += and + take no list
        pattern=r'can only (?:extend|append) array|can only concatenate list \(not "array',
        to_do=', so append one value at a time, or assign the whole list: '
        'message.position = [one, two]',
    ),
    Case(
        # such as [], which rclpy takes for an array of bytes
        pattern="of type 'DOUBLE_ARRAY', expecting type",
        to_do=', so declare it with doubles, such as [0.0, 0.0]: its type is that of its '
        'default value',
    ),
    Case(
        pattern='is not a list of one of the allowed types',
        to_do=', so write numbers of one type in a single list, such as [0.0, 0.0]',
    ),
    Case(
        pattern="'Parameter' object is not (?:subscriptable|iterable)",
        to_do=", so get its value: self.get_parameter('…').value",
    ),
)
